// Adds what leaves one translucent object after one scattering (shared/single.h), of some of the lights; with the first of
// them what stood for it in the query, which sends it out diffusely, is taken off `multiple`.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "domain/facet_class.glsl"
#include "shading/single_ray.glsl"
#include "visible.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant, scalar) uniform Push { SinglePush single_push; };
#define push single_push.picture
// On the surface, W/m^2, for its side whose normals point mainly up an axis and for the other (shading/translucent.comp).
layout(binding = 19) uniform sampler3D phi_up;
layout(binding = 20) uniform sampler3D phi_down;
layout(binding = 21) uniform sampler3D gamma_up;
layout(binding = 22) uniform sampler3D gamma_down;
layout(binding = 23) uniform sampler3D single_up;  // flux that leaves after one scattering
layout(binding = 24) uniform sampler3D single_down;
layout(binding = 25, rgba32f) uniform image2D single;

// What changes in `multiple` over F_t / (4 pi eta^2); and whether the query is negative by that.
vec3 taken_off(Hit hit, out bool negative) {
  const vec3 place = (hit.position - push.grid_low) * push.grid_inverse;
  const bool down = (facet_class(hit.normal) & 1) == 1;
  const vec3 phi = max(down ? texture(phi_down, place).rgb : texture(phi_up, place).rgb, vec3(0));
  const vec3 gamma = down ? texture(gamma_down, place).rgb : texture(gamma_up, place).rgb;
  const vec3 flux = down ? texture(single_down, place).rgb : texture(single_up, place).rgb;
  vec3 change;
  negative = false;
  for (int c = 0; c < 3; ++c) {
    const float all = query_bracket(phi[c], gamma[c], push.A, push.f_dt), rest = all - 4 * flux[c] / push.f_dt;
    negative = negative || (all >= 0 && rest < 0);
    change[c] = max(rest, 0) - max(all, 0);
  }
  return change;
}

void main() {
  const uvec2 pixel = push.corner + gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(pixel, push.camera.size))) return;
  const uint samples = push.camera.edge * push.camera.edge;
  uint todo = 0;
  for (uint s = 0; s < samples; ++s)
    if (sample_id(push.camera, pixel, s) - 1 - push.first < push.count) todo |= 1u << s;
  if (todo == 0) return;
  vec3 sum = vec3(0), change = vec3(0);
  float negative_share = 0;
  while (todo != 0) {
    const Hit hit = next_hit(push.camera, pixel, todo);
    const float cosine = clamp(dot(hit.normal, hit.to_eye), 0.001, 1);
    const float scale = hit.weight * fresnel_transmittance(cosine, grid.eta) * push.exit_scale;
    sum += scale * scattered_once(single_push.first_light, single_push.end_light,
                                  view_of(Receiver(hit.position, hit.normal, 0), hit.to_eye, cosine));
    if (single_push.first_light > 0) continue;
    bool negative;
    change += scale / (4 * 3.14159265358979) * taken_off(hit, negative);
    negative_share += negative ? hit.weight : 0;
  }
  const ivec2 at = ivec2(pixel);
  imageStore(single, at, imageLoad(single, at) + vec4(sum, 0));
  if (single_push.first_light > 0) return;
  imageStore(multiple, at, imageLoad(multiple, at) + vec4(change, 0));
  imageStore(surface, at, imageLoad(surface, at) + vec4(0, 0, 0, negative_share));
}
