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

// One sample of an area light.
struct LightPoint {
  vec3 position;    // m
  vec3 normal;      // unit, front side
  vec3 intensity;   // W/sr towards the normal: radiance times the area the sample stands for
  uint first_view;  // of its shadow maps
  uint views;       // 0: nothing shadows it
  uint two_sided;   // 1: shines from the back, too
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
  vec3 environment;  // W/m^2/sr from every direction
};

// Lights and views are uniform buffers of a fixed size (64 KiB at most; every lane reads the same entry).
const uint most_light_points = 1024;
const uint most_shadow_views = 960;

struct GatherPush {
  uint receivers;
  float eta;         // index inside / outside; 1 gathers plain irradiance
  float f_dt_outer;  // 1 - F_dr of diffuse light from outside
};

// The surface pieces of a domain's cut cells as receivers.
struct FacetPush {
  vec3 origin;      // of the grid, m
  float h;          // cell size, m
  uint cut_cells;   // entries of Domain::cut_cells
};

// Transmitted share of a light point's intensity, 1/m^2: F_t times the two cosines over the squared distance.
SHARED_FN real point_transfer(real cos_receiver, real cos_light, real distance2, real eta) {
  return fresnel_transmittance(cos_receiver, eta) * cos_receiver * cos_light / distance2;
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
