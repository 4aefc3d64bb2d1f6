// The triangle's number plus one; 0 is the background.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/shading.h"
layout(push_constant, scalar) uniform Push { VisibilityPush push; };
layout(location = 0) out uint id;
void main() { id = push.first + uint(gl_PrimitiveID) + 1; }
