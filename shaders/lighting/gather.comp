// Adds E_t of a few light samples at every receiver, one thread each. A few at a time: so the maps that all receivers look
// into stay in the cache; and that the lights are the same for all threads is plain to the compiler, which lavapipe needs
// to read them once and not lane by lane. Both together make it some three times as fast as a loop over all samples.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "gather.glsl"
layout(local_size_x = 64) in;
layout(constant_id = 0) const int part = gather_one_map;
layout(push_constant, scalar) uniform Push { GatherPush push; };
layout(binding = 3, scalar) readonly buffer Receivers { Receiver receivers[]; };
layout(binding = 4, scalar) buffer Flux { vec3 flux[]; };
layout(binding = 5, scalar) buffer Environment { vec2 environment[]; };  // so far: weight of what is blocked, of all

vec3 from_point(Receiver r, uint point, uint map) {
  const LightPoint light = points[point];
  float cos_middle;
  bool inside;
  const vec3 arriving = unshadowed(light, r.position, r.normal, push.eta, cos_middle);
  const float lit = look_up(map, r.position, r.normal, r.slack, inside);
  return (cos_middle <= 0 ? 1 : lit) * arriving;
}

vec2 from_direction(Receiver r, uint map) {
  const float cosine = max(dot(r.normal, way_of_map(views[map])), 0);
  const float weight = cosine * fresnel_transmittance(cosine, push.eta);
  bool inside;
  return weight * vec2(1 - look_up(map, r.position, r.normal, r.slack, inside), 1);
}

// gather_at_once of them, written out: the index of a loop is not known to be the same for all threads.
#define POINT(k) if (k < push.count) sum += from_point(r, push.point + k * push.step, push.map + k * push.step);
#define DIRECTION(k) if (k < push.count) open += from_direction(r, push.map + k);

void main() {
  if (gl_GlobalInvocationID.x >= push.receivers) return;
  const uint i = push.first + gl_GlobalInvocationID.x;
  const Receiver r = receivers[i];
  vec3 sum = vec3(0);
  if (part == gather_one_map) {
    POINT(0) POINT(1) POINT(2) POINT(3) POINT(4) POINT(5) POINT(6) POINT(7)
  } else if (part == gather_other_maps) {
    sum = gather_points(r.position, r.normal, r.slack, push.eta, push.point, most_light_points);
  } else {
    vec2 open = environment[i];
    DIRECTION(0) DIRECTION(1) DIRECTION(2) DIRECTION(3) DIRECTION(4) DIRECTION(5) DIRECTION(6) DIRECTION(7)
    environment[i] = open;
    // What is blocked is sampled and what is open is in closed form: an unblocked point gets exactly pi L (1 - F_dr).
    if (push.last != 0)
      sum = lighting.environment * (3.14159265358979 * push.f_dt_outer * (open.y > 0 ? 1 - open.x / open.y : 1));
  }
  flux[i] += part == gather_directions ? sum : float(push.step) * sum;
}
