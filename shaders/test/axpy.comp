// y = a x + y over a buffer and over a 3D image: the smallest pass there is, for the tests of gpu/.
#version 460
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x = 64) in;
layout(constant_id = 0) const float offset = 0.0;
layout(push_constant, scalar) uniform Push { float a; uint count; } push;
layout(binding = 0, scalar) readonly buffer X { float x[]; };
layout(binding = 1, scalar) buffer Y { float y[]; };
layout(binding = 2, r32f) uniform writeonly image3D copy;
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  y[i] = push.a * x[i] + y[i] + offset;
  imageStore(copy, ivec3(i, 0, 0), vec4(y[i]));
}
