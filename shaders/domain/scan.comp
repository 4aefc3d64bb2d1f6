// Bits set before each word, and in all: one workgroup, a run of words a thread.
#version 460
#extension GL_EXT_scalar_block_layout : require
layout(local_size_x = 256) in;
layout(push_constant, scalar) uniform Push { uint words; };
layout(binding = 0, scalar) readonly buffer Bits { uint bits[]; };
layout(binding = 1, scalar) writeonly buffer Before { uint before[]; };
layout(binding = 2, scalar) writeonly buffer Total { uint total[]; };  // as the arguments of an indirect dispatch

shared uint sums[256];

void main() {
  uint thread = gl_LocalInvocationID.x;
  uint run = (words + 255u) / 256u;
  uint first = min(thread * run, words), end = min(first + run, words);
  uint sum = 0u;
  for (uint w = first; w < end; ++w) sum += bitCount(bits[w]);
  sums[thread] = sum;
  barrier();
  if (thread == 0u) {
    uint running = 0u;
    for (int t = 0; t < 256; ++t) {
      uint mine = sums[t];
      sums[t] = running;
      running += mine;
    }
    total[0] = running;
    total[1] = 1u;
    total[2] = 1u;
  }
  barrier();
  uint running = sums[thread];
  for (uint w = first; w < end; ++w) {
    before[w] = running;
    running += bitCount(bits[w]);
  }
}
