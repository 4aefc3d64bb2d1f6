// Adds what is seen straight through one translucent object: the refracted view ray goes on through its cells, and where it
// leaves it brings in what lies behind, weakened by exp(-tau) (the reduced medium's, as the beams in lighting/beam_march.comp,
// whose unscattered rest this is). At its far end the Fresnel share leaves and the mirrored share goes on.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "lighting/gather.glsl"
#include "lighting/ray_tree.glsl"
#include "visible.glsl"
#include "shared/domain.h"
#include "shared/gather.h"
#include "shared/reflection.h"
layout(push_constant, scalar) uniform Push { ReflectionPush push; };
#include "reflection.glsl"
layout(binding = 18, scalar) uniform Grid { GatherGrid grid; };
layout(binding = 19, r32ui) uniform readonly uimage3D cut_index;
layout(binding = 20, scalar) readonly buffer CutCells { GpuCutCell cut_cells[]; };
layout(binding = 21, rgba32f) uniform readonly image3D volume;
layout(binding = 22, rgba32f) uniform readonly image3D kappa;
layout(binding = 23, rgba32f) uniform readonly image3D absorption;
layout(binding = 24, rgba32f) uniform image2D single;
layout(binding = 25, scalar) readonly buffer OpenPixels { uint open_groups[3], open_count, open_pixels[]; };
#define GRID grid
#include "domain/way.glsl"
#include "domain/way_end.glsl"
layout(local_size_x = 8, local_size_y = OPEN_GROUP / 8) in;
layout(constant_id = 0) const int listed = 0;  // 0: all pixels of the rectangle

float largest(vec3 v) { return max(v.x, max(v.y, v.z)); }

// Takes what is scattered and absorbed on the way `w` through the object. Returns its end, or `nowhere` where too little is left.
// The mesh is searched as far as the way is likely to go, and then as far again.
End cross_object(Way w, inout vec3 left) {
  const int most_steps = grid.cells.x + grid.cells.y + grid.cells.z;
  const float reach = likely_reach(w, -log(STRAIGHT_LEAST_SHARE));
  float searched = 0;
  End end = End(nowhere, w.along);
  vec3 sigma_t = vec3(0);
  for (int n = 0; n < most_steps && largest(left) > STRAIGHT_LEAST_SHARE; ++n) {
    if (cell_end(w) > searched && end.at == nowhere) {
      const float near = searched;
      searched = cell_end(w) + reach;
      end = mesh_end(w.from, w.along, near, searched);
    }
    if (w.at >= end.at) return end;
    const Solid s = solid_at(w.cell);
    if (s.there) sigma_t = grid.channels == 1 ? s.sigma_t.rrr : s.sigma_t;
    left *= exp(-sigma_t * (min(cell_end(w), end.at) - w.at));
    step_on(w);
  }
  end.at = nowhere;
  return end;
}

// What is seen through the object, W/m^2/sr: straight light, and what other surfaces sent that was scattered there.
struct Behind {
  vec3 straight, scattered;
};

// W/m^2/sr that arrive at `hit` from inside, straight from behind, without the Fresnel factor of the view.
Behind behind(Hit hit, float cosine, vec3 turn, LightShare lights) {
  const vec3 from = (hit.position - grid.origin) / grid.h;
  const vec3 inwards =
      normalize((cosine * hit.normal - hit.to_eye) / grid.eta - refracted_cosine(cosine, grid.eta) * hit.normal);
  Way w = way_from(from, inwards, ivec3(floor(from - 1e-3 * hit.normal)));
  vec3 left = vec3(1);
  Behind sum = Behind(vec3(0), vec3(0));
  for (int mirrors = 0; mirrors <= BEAM_MOST_REFLECTIONS; ++mirrors) {
    const End end = cross_object(w, left);
    if (end.at == nowhere) break;
    const vec3 normal = end.normal;
    const float inside = dot(normal, w.along), outside = refracted_cosine(inside, 1 / grid.eta);
    const float reflectance = fresnel_reflectance(inside, 1 / grid.eta);
    const vec3 place = w.from + end.at * w.along;
    const float share = mirrors == BEAM_MOST_REFLECTIONS && outside > 0 ? 1 : 1 - reflectance;
    if (share * largest(left) > STRAIGHT_LEAST_SHARE) {
      const vec3 outwards = normalize(grid.eta * w.along + (outside - grid.eta * inside) * normal);
      const Mirrored seen = follow(Leaving(grid.origin + grid.h * place, outwards, 1, 0), lights, push.orders, turn);
      sum.straight += share * left * seen.surface;
      sum.scattered += share * left * seen.multiple;
    }
    left *= reflectance;
    if (largest(left) < STRAIGHT_LEAST_SHARE) break;
    const vec3 back = normalize(w.along - 2 * inside * normal);
    w = way_from(place - 1e-4 * normal, back, ivec3(floor(place - 1e-3 * normal)));
  }
  return sum;
}

void main() {
  uvec2 pixel = push.corner + gl_GlobalInvocationID.xy;
  if (listed != 0) {
    const uint slot = gl_WorkGroupID.x * OPEN_GROUP + gl_LocalInvocationIndex;
    if (slot >= open_count) return;
    pixel = uvec2(open_pixels[slot] % push.camera.size.x, open_pixels[slot] / push.camera.size.x);
  }
  if (any(greaterThanEqual(pixel, push.camera.size))) return;
  const uint samples = push.camera.edge * push.camera.edge;
  uint todo = 0;
  for (uint s = push.first_sample; s < push.end_sample; ++s)
    if (sample_id(push.camera, pixel, s) - 1 - push.first < push.count) todo |= 1u << s;
  if (todo == 0) return;
  Behind sum = Behind(vec3(0), vec3(0));
  for (; todo != 0; todo &= todo - 1) {
    const uint s = uint(findLSB(todo));
    const Hit hit = sample_hit(push.camera, pixel, s);
    const float cosine = clamp(dot(hit.normal, hit.to_eye), 0.001, 1);
    const float share = fresnel_transmittance(cosine, grid.eta) / float(samples);
    const Behind seen = behind(hit, cosine, turn_of(pixel), asked_of(s, samples));
    sum.straight += share * seen.straight;
    sum.scattered += share * seen.scattered;
  }
  const ivec2 at = ivec2(pixel);
  imageStore(multiple, at, imageLoad(multiple, at) + vec4(sum.scattered, 0));
  imageStore(single, at, imageLoad(single, at) + vec4(sum.straight, 0));
}
