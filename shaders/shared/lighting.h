// What lights a scene, as the shaders see it: light points, shadow maps, receivers; and the arithmetic of one sample.
#ifndef ALABASTER_SHARED_LIGHTING_H
#define ALABASTER_SHARED_LIGHTING_H
#include "language.h"
#include "optics.h"

ALABASTER_BEGIN_SHARED

// A place whose incoming light is wanted, world space.
struct Receiver {
  vec3 position;  // m
  vec3 normal;    // unit, outward
  // m; how far the point may lie off the surface it stands for: it is lifted by that much, so nothing so near shadows it.
  // About a tenth of a cell for a bent facet of a cut cell (facet_receivers.comp; half a cell lets light in where things
  // touch), 0 for points of the mesh itself.
  float slack;
};

// Kinds of light samples: of an emissive mesh, from its front or from both sides; and of lights without a mesh.
const uint light_one_sided = 0;
const uint light_two_sided = 1;
const uint light_point = 2;
const uint light_spot = 3;
const uint light_directional = 4;

// A spot's fall from its inner to its outer cone (KHR_lights_punctual): share = clamp(scale * cosine + offset, 0, 1)^2.
struct SpotCone {
  float scale;
  float offset;
};

// One sample of a light.
struct LightPoint {
  vec3 position;    // m; directional: unused
  vec3 normal;      // unit: of the mesh's front side, or where a spot or directional light shines
  // W/sr along the normal (of a mesh: radiance times the area the sample stands for); directional: W/m^2 across its way
  vec3 intensity;
  uint first_view;  // of its shadow maps
  uint views;       // 0: nothing shadows it
  uint kind;        // light_*
  SpotCone cone;    // spot; of a directional light `scale` is its spread: a part of the sky, half its width as a cosine
                    // at right angles to its direction
};

// One shadow map; its layer is its index. Depth is D32, clip z / w, LESS_OR_EQUAL is lit.
struct ShadowView {
  mat4 to_clip;      // world to clip space; outside the frustum everything is lit
  float half_width;  // of the map at clip w = 1: m, or for a perspective map a tangent
};

struct LightingHeader {
  uint points;       // area samples
  uint directions;   // of the environment
  uint first_view;   // of the directions, one each
  float map_size;    // texels along an edge
  vec3 environment;  // W/m^2/sr from every direction; a picture of it is among the points
};

// Lights and views are uniform buffers of a fixed size (64 KiB at most; every lane reads the same entry).
const uint most_light_points = 1024;
const uint most_shadow_views = 960;

// Parts of a gather (gather.comp).
const int gather_one_map = 0;     // light points of one map each
const int gather_other_maps = 1;  // a point with none or several
const int gather_directions = 2;  // of the environment
const uint gather_at_once = 8;    // points or directions

struct GatherPush {
  uint receivers;
  float eta;         // index inside / outside; 1 gathers plain irradiance
  float f_dt_outer;  // 1 - F_dr of diffuse light from outside
  uint first;        // of the receivers
  uint point, map;   // the first; the others follow, every step-th, and count as often as those between them
  uint count, step;
  uint last;         // 1: no directions are left
};

// The surface pieces of a domain's cut cells as receivers.
struct FacetPush {
  vec3 origin;      // of the grid, m
  float h;          // cell size, m
  uint cut_cells;   // entries of Domain::cut_cells
};

// Where the light of the open environment and of surfaces comes from (arrivals.glsl): the links of light between surfaces
// (shared/exchange.h), so that what is open and what surfaces send instead are told apart by the same rays; or, without
// sides, the environment's alone from the lighting's own directions.
struct SkyLinks {
  uint sides;
  uint directions;  // 0: all are dark
  uint only_known;  // 1: what surfaces send, without the environment
};
const uint sky_no_side = 0xffffffffu;

// Light that enters with its direction kept: shaders/lighting/directional_source.comp.
struct EntryPush {
  uint receivers;
  float eta;
  float f_dt_outer;  // 1 - F_dr of diffuse light from outside
  float A, f_dt;     // of the surface from inside
  SkyLinks sky;
};

SHARED_FN real spot_share(real cosine, real scale, real offset) {
  real share = min(max(scale * cosine + offset, real(0)), real(1));
  return share * share;
}

// What a light sample sends, over its intensity, at an angle with the given cosine to its normal.
SHARED_FN real light_share(uint kind, real cosine, real cone_scale, real cone_offset) {
  if (kind == light_two_sided) return abs(cosine);
  if (kind == light_spot) return spot_share(cosine, cone_scale, cone_offset);
  return kind == light_one_sided ? cosine : real(1);
}

// Transmitted share of a light point's intensity, 1/m^2: F_t and the receiver's cosine times what the light
// sends there (light_share) over the squared distance.
SHARED_FN real point_transfer(real cos_receiver, real sent, real distance2, real eta) {
  return fresnel_transmittance(cos_receiver, eta) * cos_receiver * sent / distance2;
}

// Mean over a strip of cosines from `cosine - spread` to `cosine + spread` of what is above the horizon.
SHARED_FN real cosine_above_horizon(real cosine, real spread) {
  if (cosine >= spread) return cosine;
  if (cosine <= -spread) return real(0);
  return (cosine + spread) * (cosine + spread) / (real(4) * spread);
}

// Mean cosine of the part of that strip that is above the horizon.
SHARED_FN real cosine_of_visible_part(real cosine, real spread) {
  return max(cosine, real(0.5) * (cosine + spread));
}

// How far along its normal a receiver is moved before it is looked up in a shadow map, m. A surface's depth, read up to
// one texel away along each axis of the map (2x2 filter), is off its tangent plane by at most
// texel * (|n.u| + |n.v|), u and v the map's axes: with that shift a convex surface never shadows itself, at any angle.
// clip_normal = to_clip * (n, 0), which is n.u and n.v over half_width; the last term covers rounding.
SHARED_FN real shadow_shift(real clip_normal_x, real clip_normal_y, real w, real half_width, real map_size) {
  real texel = real(2) * half_width * w / map_size;
  return texel * (half_width * (abs(clip_normal_x) + abs(clip_normal_y)) + real(0.05));
}

ALABASTER_END_SHARED

#endif
