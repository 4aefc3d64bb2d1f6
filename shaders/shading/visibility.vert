// Which triangle each sample of the picture sees.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/shading.h"
layout(push_constant, scalar) uniform Push { VisibilityPush push; };
layout(location = 0) in vec3 position;
void main() { gl_Position = push.to_clip * vec4(position, 1); }
