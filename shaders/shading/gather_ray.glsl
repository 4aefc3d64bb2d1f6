// What arrives at a point of the surface from inside, along one direction: the source sigma_s' (phi + phi_b) gathered along the
// ray, both with their closure and phi_b also spread, and at its far end what the surface there mirrors. Takes bindings 11, 12 and 16 to 30.
#include "domain/facet_class.glsl"
#include "lighting/ray_tree.glsl"
#include "shared/domain.h"
#include "shared/gather.h"
layout(binding = 16, scalar) uniform Grid { GatherGrid grid; };
layout(binding = 17, r32ui) uniform readonly uimage3D cut_index;
layout(binding = 18, scalar) readonly buffer CutCells { GpuCutCell cut_cells[]; };
layout(binding = 19, rgba32f) uniform readonly image3D volume;
layout(binding = 20, rgba32f) uniform readonly image3D kappa;
layout(binding = 21, rgba32f) uniform readonly image3D absorption;
layout(binding = 22) uniform sampler3D beam_fluence;  // phi_b of what is scattered below the skin, W/m^2
layout(binding = 23) uniform sampler3D near_up;       // scattered in the facets' skin, W/m^2; mean cosine
layout(binding = 24) uniform sampler3D near_down;
layout(binding = 25) uniform sampler3D field_up;      // phi for the surface's two sides, W/m^2
layout(binding = 26) uniform sampler3D field_down;
layout(binding = 27) uniform sampler3D drive_up;      // the query's Gamma
layout(binding = 28) uniform sampler3D drive_down;
layout(binding = 29) uniform sampler3D unscattered;  // share of the beams' light that no surface has sent
layout(binding = 30) uniform sampler3D beam_shift;   // of beam_shift.comp, W/m^2
#define GRID grid
#include "domain/way.glsl"
#include "domain/way_end.glsl"

vec3 place_of(vec3 p) { return p / vec3(grid.cells); }

vec3 field(vec3 p, bool down) {
  return max(down ? texture(field_down, place_of(p)).rgb : texture(field_up, place_of(p)).rgb, vec3(0));
}

// Bracket of the render query at a point of the surface: 4 / F_dt of the flux that leaves.
vec3 bracket_at(vec3 p, bool down) {
  const vec3 phi = field(p, down), gamma = down ? texture(drive_down, place_of(p)).rgb : texture(drive_up, place_of(p)).rgb;
  return max((1 + 1 / grid.A) * phi - 4 * gamma / (grid.f_dt * grid.A), vec3(0));
}

// Between the two sheets of a thin part phi is that of the nearer one.
bool side_at(vec3 p, ivec3 cell, bool down) {
  const uint index = imageLoad(cut_index, cell).r;
  if (index == 0 || cut_cells[index].side[0].area <= 0 || cut_cells[index].side[1].area <= 0) return down;
  const GpuFacet up = cut_cells[index].side[0], other = cut_cells[index].side[1];
  const vec3 at = p - vec3(cell);
  const float to_up = abs(dot(normalize(up.area_vector), at - up.centre)),
              to_down = abs(dot(normalize(other.area_vector), at - other.centre));
  return to_down < to_up;
}

// See gather_closure(); linear in the table.
vec2 closure_of(float albedo) {
  const float place = sqrt(clamp((1 - albedo) / GATHER_MOST_ABSORBED, 0, 1)) * (GATHER_CLOSURES - 1);
  const int before = min(int(place), GATHER_CLOSURES - 2);
  return mix(grid.closure[before], grid.closure[before + 1], place - float(before));
}

// Of an outside cosine; see GatherClosures::exit().
float exit_of(float cosine) {
  const float place = sqrt(clamp(cosine, 0, 1)) * (GATHER_EXITS - 1);
  const int before = min(int(place), GATHER_EXITS - 2);
  return mix(grid.exit[before], grid.exit[before + 1], place - float(before));
}

// 4 pi times radiance, W/m^2: all that arrives, and of it what was scattered once (sigma_s' phi_b, of lamps and sky alone).
struct Gathered {
  vec3 all, single;
  bool open;  // light goes through straight
};

// How deep the near light of a facet reaches, h (lighting/beam_march.comp).
float near_depth_at(vec3 p, vec3 normal, bool down) {
  const float usual = BEAM_NEAR_DEPTH;
  if (solid_at(ivec3(floor(p - 1.25 * normal))).there && solid_at(ivec3(floor(p - 0.75 * normal))).there) return usual;
  const GpuFacet side = cut_cells[imageLoad(cut_index, ivec3(floor(p - 1e-3 * normal))).r].side[down ? 1 : 0];
  return side.area > 0 ? clamp(side.distance, 0.05, usual) : usual;
}

// What the light near the facet at `p` adds to a ray that starts there, or ends there (`behind`). `tau` is the ray's.
void add_near(vec3 p, vec3 normal, Solid s, float view, vec3 tau, bool behind, inout Gathered sum) {
  const bool down = (facet_class(normal) & 1) == 1;
  const vec4 near_ = down ? texture(near_down, place_of(p)) : texture(near_up, place_of(p));
  const float depth = near_depth_at(p, normal, down);
  const float mu = max(near_.a, 0.05), thickness = (s.sigma_t.r + s.sigma_t.g + s.sigma_t.b) / 3,
              skin = min(depth, skin_depth(thickness / mu, grid.skin));
  const vec3 own = texture(unscattered, place_of(p)).rgb;
  for (int c = 0; c < 3; ++c) {
    const NearLight n = NearLight(near_[c], mu, max(skin * s.sigma_t[c], 1e-4), max(depth * s.sigma_t[c], 1e-4), s.albedo[c], view,
                                  tau[c]);
    const float once = behind ? near_single_behind(n) : near_single(n);
    sum.single[c] += own[c] * once;
    sum.all[c] += dot(closure_of(s.albedo[c]), vec2(behind ? -near_surplus_behind(n) : -near_surplus(n), once));
  }
}

// What arrives at `from` (h, from the grid's corner), on the surface with this normal, along -`along` (unit, inwards). Beyond what
// is gathered the way is followed to an optical depth of `follow`, to see whether it is open.
Gathered gather_along(vec3 from, vec3 normal, vec3 along, float follow) {
  const bool down = (facet_class(normal) & 1) == 1;
  Way w = way_from(from, along, ivec3(floor(from - 1e-3 * normal)));
  Gathered sum = Gathered(vec3(0), vec3(0), true);
  Solid first = Solid(false, vec3(0), vec3(0));
  vec3 left = vec3(1), tau = vec3(1e3);
  bool inside = false, deep = false;
  const int most_steps = grid.cells.x + grid.cells.y + grid.cells.z;
  // The mesh is searched as far as the way is likely to go, and then as far again.
  const float reach = likely_reach(w, max(1.5 * GATHER_DEEP, 1.1 * follow));
  float searched = 0;
  End out_ = End(nowhere, along);
  // Cells without solid on the way are slivers that were left out: like the cell before.
  Solid s = Solid(false, vec3(0), vec3(0));
  for (int n = 0; n < most_steps; ++n) {
    if (cell_end(w) > searched && out_.at == nowhere) {
      const float near = searched;
      searched = cell_end(w) + reach;
      out_ = mesh_end(from, along, near, searched);
    }
    if (w.at >= out_.at) break;
    const Solid here = solid_at(w.cell);
    if (here.there) {
      s = here;
      if (grid.channels == 1) s.sigma_t = s.sigma_t.rrr, s.albedo = s.albedo.rrr;
    }
    if (!s.there) {
      if (w.at > 2) break;
      step_on(w);
      continue;
    }
    if (!inside) first = s;
    inside = true;
    const float end = min(out_.at, cell_end(w)), length_ = end - w.at;
    const vec3 depth = s.sigma_t * length_, lost = left * (1 - exp(-depth));
    if (deep) {
      left -= lost;
      sum.open = max(left.x, max(left.y, left.z)) * exp(follow) >= 1;
      if (!sum.open || end == out_.at) break;
      step_on(w);
      continue;
    }
    const vec3 own = texture(unscattered, place_of(w.from + (w.at + 0.5 * length_) * along)).rgb;
    for (int c = 0; c < 3; ++c) {
      if (c > 0 && grid.channels == 1) break;
      const vec3 p = w.from + (w.at + length_ * loss_place(depth[c])) * along;
      const float beams = texture(beam_fluence, place_of(p))[c], scattered = lost[c] * s.albedo[c];
      sum.single[c] += own[c] * scattered * beams;
      const vec2 closure = closure_of(s.albedo[c]);
      const float shift = texture(beam_shift, place_of(p))[c];  // single scattering stays where it is
      sum.all[c] += scattered * (dot(closure, vec2(field(p, side_at(p, w.cell, down))[c], beams)) + (closure.y - 1) * shift);
    }
    left -= lost;
    const vec3 at_end = w.from + end * along;
    deep = max(left.x, max(left.y, left.z)) * exp(GATHER_DEEP) < 1;
    if (deep) {
      sum.all += left * s.albedo * field(at_end, down);
      if (end == out_.at || follow <= GATHER_DEEP) break;
    } else if (end == out_.at) {
      const float cosine = max(dot(out_.normal, along), 1e-3), mirrored = fresnel_reflectance(cosine, 1 / grid.eta);
      tau = -log(max(left, vec3(1e-30)));
      add_near(at_end, out_.normal, s, cosine, tau, true, sum);
      sum.all += left * mirrored * bracket_at(at_end, (facet_class(out_.normal) & 1) == 1);
      break;
    }
    step_on(w);
  }
  if (inside) add_near(from, normal, first, max(-dot(normal, along), 1e-3), tau, false, sum);  // edge-on rounding may turn it
  if (grid.channels == 1) sum = Gathered(sum.all.rrr, sum.single.rrr, sum.open);
  return sum;
}

// Inwards, from the direction that it leaves by outside.
vec3 refracted_inwards(vec3 outside, vec3 normal, float cosine) {
  return normalize((cosine * normal - outside) / grid.eta - refracted_cosine(cosine, grid.eta) * normal);
}
