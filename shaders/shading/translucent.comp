// Adds one translucent object to the picture: the render query (Eq. 14, with the exit scale) on its surface.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "domain/facet_class.glsl"
#include "shared/optics.h"
#include "visible.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant, scalar) uniform Push { TranslucentPush push; };
// On the surface, W/m^2, for its side whose normals point mainly up an axis and for the other.
layout(binding = 11) uniform sampler3D phi_up;
layout(binding = 12) uniform sampler3D phi_down;
layout(binding = 13) uniform sampler3D gamma_up;  // Gamma_s of the facets
layout(binding = 14) uniform sampler3D gamma_down;
void main() {
  const uvec2 pixel = push.corner + gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(pixel, push.camera.size))) return;
  const uint samples = push.camera.edge * push.camera.edge;
  uint todo = 0;
  for (uint s = 0; s < samples; ++s)
    if (sample_id(push.camera, pixel, s) - 1 - push.first < push.count) todo |= 1u << s;
  if (todo == 0) return;

  vec4 multiple_sum = vec4(0), surface_sum = vec4(0), fluence_sum = vec4(0), gamma_sum = vec4(0), normal_sum = vec4(0);
  while (todo != 0) {
    const Hit hit = next_hit(push.camera, pixel, todo);
    const vec3 place = (hit.position - push.grid_low) * push.grid_inverse;
    const bool down = (facet_class(hit.normal) & 1) == 1;
    const vec3 phi_here = max(down ? texture(phi_down, place).rgb : texture(phi_up, place).rgb, vec3(0));
    const vec3 gamma = down ? texture(gamma_down, place).rgb : texture(gamma_up, place).rgb;
    const float cos_eye = clamp(dot(hit.normal, hit.to_eye), 0, 1);
    const float f_t = fresnel_transmittance(cos_eye, push.eta);
    vec3 radiance;
    bool negative = false;
    for (int c = 0; c < 3; ++c) {
      const float bracket = query_bracket(phi_here[c], gamma[c], push.A, push.f_dt);
      negative = negative || bracket < 0;
      radiance[c] = query_radiance(max(bracket, 0), f_t, push.exit_scale);
    }
    multiple_sum += hit.weight * vec4(radiance, 1);
    surface_sum += hit.weight * vec4(0, 0, 0, negative ? 1 : 0);
    fluence_sum += hit.weight * vec4(phi_here, hit.distance);
    gamma_sum += hit.weight * vec4(gamma, 1);
    normal_sum += hit.weight * vec4(hit.normal, 0);
  }
  const ivec2 at = ivec2(pixel);
  imageStore(multiple, at, imageLoad(multiple, at) + multiple_sum);
  imageStore(surface, at, imageLoad(surface, at) + surface_sum);
  imageStore(fluence, at, imageLoad(fluence, at) + fluence_sum);
  imageStore(gamma_s, at, imageLoad(gamma_s, at) + gamma_sum);
  imageStore(normals, at, imageLoad(normals, at) + normal_sum);
}
