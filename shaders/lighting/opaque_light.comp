// Radiance of Lambert places: their irradiance times the albedo / pi that link_opaque.comp left.
#version 460
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { uint first, count; };
layout(binding = 0, scalar) readonly buffer Irradiance { vec3 irradiance[]; };  // W/m^2
layout(binding = 1, scalar) buffer Transmitted { vec3 transmitted[]; };          // of emitters, W/m^2/sr

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i < count) transmitted[first + i] *= irradiance[i];
}
