// The numbers of the bits that are set, in order. One thread a word.
#version 460
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { uint words; };
layout(binding = 0, scalar) readonly buffer Bits { uint bits[]; };
layout(binding = 1, scalar) readonly buffer Before { uint before[]; };
layout(binding = 2, scalar) writeonly buffer List { uint list[]; };

void main() {
  uint w = gl_GlobalInvocationID.x;
  if (w >= words) return;
  uint word = bits[w], at = before[w];
  while (word != 0u) {
    list[at++] = 32u * w + uint(findLSB(word));
    word &= word - 1u;
  }
}
