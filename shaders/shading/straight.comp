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
#define GRID grid
#include "domain/way.glsl"
#include "domain/way_end.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

const float least_share = 1e-4;  // of the light behind that is worth a ray

float largest(vec3 v) { return max(v.x, max(v.y, v.z)); }

// Takes what is scattered and absorbed from `w` to where it leaves the object; false where nothing worth it does. `end` and
// `normal` are where and through what.
bool cross_object(inout Way w, inout vec3 left, out float end, out vec3 normal) {
  bool inside = false;
  const int most_steps = grid.cells.x + grid.cells.y + grid.cells.z;
  for (int n = 0; n < most_steps && largest(left) > least_share; ++n) {
    const Solid s = solid_at(w.cell);
    end = cell_end(w);
    if (!s.there && (inside || w.at > 2)) return inside;  // fell out where the surface is bent
    if (s.there) {
      inside = true;
      vec3 through;
      const float out_at = leaves_at(w, imageLoad(cut_index, w.cell).r, end, through);
      // Near its start the way is in the facet's plane but for the surface's bend: nothing leaves there.
      const bool leaves = out_at <= end && out_at > 0.25 && !mesh_goes_on(w, out_at);
      if (leaves) end = out_at;
      left *= exp(-(grid.channels == 1 ? s.sigma_t.rrr : s.sigma_t) * (end - w.at));
      normal = through;
      if (leaves) return true;
      normal = w.along;
    }
    step_on(w);
  }
  return false;
}

// W/m^2/sr that arrive at `hit` from inside, straight from behind, without the Fresnel factor of the view.
vec3 behind(Hit hit, float cosine, vec3 turn, LightShare lights) {
  const vec3 from = (hit.position - grid.origin) / grid.h;
  const vec3 inwards =
      normalize((cosine * hit.normal - hit.to_eye) / grid.eta - refracted_cosine(cosine, grid.eta) * hit.normal);
  Way w = way_from(from, inwards, ivec3(floor(from - 1e-3 * hit.normal)));
  vec3 left = vec3(1), sum = vec3(0);
  for (int mirrors = 0; mirrors <= BEAM_MOST_REFLECTIONS; ++mirrors) {
    float end;
    vec3 normal;
    if (!cross_object(w, left, end, normal)) break;
    const float inside = dot(normal, w.along), outside = refracted_cosine(inside, 1 / grid.eta);
    const float reflectance = fresnel_reflectance(inside, 1 / grid.eta);
    const vec3 place = w.from + end * w.along;
    const float share = mirrors == BEAM_MOST_REFLECTIONS && outside > 0 ? 1 : 1 - reflectance;
    if (share * largest(left) > least_share) {
      const vec3 outwards = normalize(grid.eta * w.along + (outside - grid.eta * inside) * normal);
      const Mirrored seen = follow(Leaving(grid.origin + grid.h * place, outwards, 1, 0), lights, push.orders, turn);
      sum += share * left * (seen.surface + seen.multiple);
    }
    left *= reflectance;
    if (largest(left) < least_share) break;
    w = way_from(place, normalize(w.along - 2 * inside * normal), w.cell);
  }
  return sum;
}

void main() {
  const uvec2 pixel = push.corner + gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(pixel, push.camera.size))) return;
  const uint samples = push.camera.edge * push.camera.edge;
  uint todo = 0;
  for (uint s = push.first_sample; s < push.end_sample; ++s)
    if (sample_id(push.camera, pixel, s) - 1 - push.first < push.count) todo |= 1u << s;
  if (todo == 0) return;
  vec3 sum = vec3(0);
  for (; todo != 0; todo &= todo - 1) {
    const uint s = uint(findLSB(todo));
    const Hit hit = sample_hit(push.camera, pixel, s);
    const float cosine = clamp(dot(hit.normal, hit.to_eye), 0.001, 1);
    sum += fresnel_transmittance(cosine, grid.eta) * behind(hit, cosine, turn_of(pixel), asked_of(s, samples));
  }
  const ivec2 at = ivec2(pixel);
  imageStore(multiple, at, imageLoad(multiple, at) + vec4(sum / float(samples), 0));
}
