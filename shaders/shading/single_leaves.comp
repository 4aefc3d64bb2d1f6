// What leaves facets after one scattering as the picture draws it, of some of the lights: on each side that is asked along one
// direction, spread by the cosine over all of them; pi F_t L / eta^2 is then in the mean the flux.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shading/single_ray.glsl"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { SingleLeavesPush push; };
layout(binding = 19, scalar) readonly buffer Receivers { Receiver receivers[]; };  // two a cut cell
layout(binding = 20, scalar) buffer Leaves { vec4 leaves[]; };                     // W/m^2, of those asked

void main() {
  const uint k = gl_GlobalInvocationID.x;
  if (k >= push.count) return;
  if (push.first_light == 0) leaves[k] = vec4(0);
  const Receiver receiver = receivers[k * push.stride];
  if (receiver.normal == vec3(0)) return;
  // Two irrational steps cover the square evenly (M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018).
  const float square = fract(0.5 + 0.7548776662 * float(k)), angle = 6.28318531 * fract(0.5 + 0.5698402910 * float(k));
  const float cosine = sqrt(square), sine = sqrt(1 - square);
  const vec3 n = receiver.normal;
  const vec3 across = normalize(abs(n.x) < 0.6 ? cross(n, vec3(1, 0, 0)) : cross(n, vec3(0, 1, 0)));
  const vec3 outside = cosine * n + sine * (cos(angle) * across + sin(angle) * cross(n, across));
  const float scale = 3.14159265358979 * fresnel_transmittance(cosine, grid.eta) / (grid.eta * grid.eta);
  leaves[k].rgb += scale * scattered_once(push.first_light, push.end_light, view_of(receiver, outside, cosine));
}
