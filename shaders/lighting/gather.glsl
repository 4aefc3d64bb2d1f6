// The light of samples at a point: E_t = integral F_t(w) L (n.w) dw, the report's Eq. 5 without its
// exponential. Needs scalar block layout; takes bindings 0 to 2.
#include "shared/lighting.h"

layout(binding = 0, scalar) uniform Lights { LightingHeader lighting; LightPoint points[most_light_points]; };
layout(binding = 1, scalar) uniform Views { ShadowView views[most_shadow_views]; };
layout(binding = 2) uniform sampler2DArrayShadow shadow_maps;

// 1 lit, 0 in shadow, between at a shadow's edge (2x2 comparisons, bilinear); `inside` says whether the map holds the
// point.
float look_up(uint map, vec3 position, vec3 normal, float slack, out bool inside) {
  const ShadowView view = views[map];
  vec4 clip = view.to_clip * vec4(position, 1);
  const vec4 clip_normal = view.to_clip * vec4(normal, 0);
  clip += (slack + shadow_shift(clip_normal.x, clip_normal.y, clip.w, view.half_width, lighting.map_size)) * clip_normal;
  inside = max(abs(clip.x), abs(clip.y)) < clip.w;
  if (!inside) return 1;
  const vec3 p = clip.xyz / clip.w;
  return texture(shadow_maps, vec4(0.5 * p.xy + 0.5, map, p.z));
}

// By the first of a sample's maps that holds the point.
float lit_share(LightPoint light, vec3 position, vec3 normal, float slack) {
  float lit = 1;
  bool inside = light.views == 0;
  uint v = 0;
  do {  // not `for`: lavapipe would run the loop once more than there are maps
    const float found = look_up(min(light.first_view + v, most_shadow_views - 1), position, normal, slack, inside);
    lit = v < light.views ? found : lit;
  } while (++v < light.views && !inside);
  return lit;
}

// Unit direction from `position` to a sample; `distance2` is what its intensity falls with, m^2, or 1.
vec3 way_to(LightPoint light, vec3 position, out float distance2) {
  distance2 = 1;
  if (light.kind == light_directional) return -light.normal;
  const vec3 way = light.position - position;
  distance2 = dot(way, way);
  return way * inversesqrt(max(distance2, 1e-30));
}

// Unit, towards the environment where a map of it looks from: row 2 of its orthographic matrix is the light's way.
vec3 way_of_map(ShadowView view) {
  return -normalize(vec3(view.to_clip[0][2], view.to_clip[1][2], view.to_clip[2][2]));
}

// What a light sample sends to a place where nothing is in between, W/m^2. A map of a light whose middle is below the horizon
// would say that the surface shadows itself: `cos_middle` <= 0.
vec3 unshadowed(LightPoint light, vec3 position, vec3 normal, float eta, out float cos_middle) {
  float distance2;
  const vec3 w = way_to(light, position, distance2);
  cos_middle = dot(normal, w);
  const float spread = light.kind == light_directional ? light.cone.scale : 0;
  const float cos_receiver = cosine_above_horizon(cos_middle, spread);
  const float sent = light_share(light.kind, -dot(light.normal, w), light.cone.scale, light.cone.offset);
  if (cos_receiver <= 0 || sent <= 0) return vec3(0);
  const float visible = cosine_of_visible_part(cos_middle, spread);
  return light.intensity * (cos_receiver / visible * point_transfer(visible, sent, distance2, eta));
}

// Of the points first, first + stride, ...; `stride` such parts add up to the whole.
vec3 gather_points(vec3 position, vec3 normal, float slack, float eta, uint first, uint stride) {
  vec3 sum = vec3(0);
  for (uint i = first; i < lighting.points; i += stride) {
    const LightPoint light = points[i];
    float cos_middle;
    const vec3 arriving = unshadowed(light, position, normal, eta, cos_middle);
    sum += (cos_middle > 0 ? lit_share(light, position, normal, slack) : 1) * arriving;
  }
  return sum;
}

vec3 environment_way(uint direction) { return way_of_map(views[lighting.first_view + direction]); }

// Share of the uniform environment's transmitted flux that is not blocked. What is blocked is sampled and what is open
// is in closed form, so an unblocked point gets exactly pi L (1 - F_dr).
float environment_openness(vec3 position, vec3 normal, float slack, float eta) {
  float blocked = 0, all = 0;
  for (uint i = 0; i < lighting.directions; ++i) {
    const uint view = lighting.first_view + i;
    const float cos_receiver = dot(normal, environment_way(i));
    if (cos_receiver <= 0) continue;
    const float weight = cos_receiver * fresnel_transmittance(cos_receiver, eta);
    bool inside;
    all += weight;
    blocked += weight * (1 - look_up(view, position, normal, slack, inside));
  }
  return all > 0 ? 1 - blocked / all : 1;
}
