// Depth is all a shadow map holds.
#version 460
void main() {}
