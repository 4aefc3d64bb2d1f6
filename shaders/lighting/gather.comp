// E_t at every receiver, one thread each.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "gather.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { GatherPush push; };
layout(binding = 3, scalar) readonly buffer Receivers { Receiver receivers[]; };
layout(binding = 4, scalar) writeonly buffer Flux { vec3 flux[]; };
void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.receivers) return;
  const Receiver r = receivers[i];
  flux[i] = push.environment != 0 ? gather(r.position, r.normal, r.slack, push.eta, push.f_dt_outer)
                                  : gather_points(r.position, r.normal, r.slack, push.eta, 0, 1);
}
