// A shadow map: depth only.
#version 460
#extension GL_EXT_scalar_block_layout : require
layout(push_constant, scalar) uniform Push { mat4 to_clip; } push;
layout(location = 0) in vec3 position;
void main() { gl_Position = push.to_clip * vec4(position, 1); }
