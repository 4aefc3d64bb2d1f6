// Marches light samples (push.first to push.end) from one start (push.round) of each facet that has it into the object and lays
// down what they lose: one thread a facet. What the facets keep is added to what the samples and starts before left there.
//
// In each cell the beam loses units by exp(-sigma_t' s) with the cell's reduced coefficients; the scattered share becomes a
// source, the rest is absorbed. A loss between two cells' centroids along the way is shared between them so that its mean depth
// below the entry is kept. What is lost nearer to the facet than a cell can tell goes to the boundary condition (buried_*,
// shared/beam.h): so nothing depends on the grid where the mean free path is below a cell. At the far side the Fresnel share
// leaves, by the facet there, and the mirrored share is marched on.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/beam.h"
#include "shared/diffusion.h"
#include "shared/domain.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Constants { BeamPush push; };
#include "lighting/arrivals.glsl"
layout(binding = 3, scalar) readonly buffer Receivers { Receiver receivers[]; };  // two a cut cell
layout(binding = 4, scalar) readonly buffer Media { FacetMedium media[]; };       // one a cut cell
layout(binding = 5, r32ui) uniform readonly uimage3D cut_index;
layout(binding = 6, scalar) readonly buffer CutCells { GpuCutCell cut_cells[]; };
layout(binding = 7, rgba32f) uniform readonly image3D volume;
layout(binding = 8, rgba32f) uniform readonly image3D kappa;       // in kappa_scale
layout(binding = 9, rgba32f) uniform readonly image3D absorption;  // sigma_a h^2 / kappa_scale
#define GRID push
#include "domain/facet_class.glsl"
#include "domain/way.glsl"
layout(binding = 10, scalar) buffer Deposits { uint deposits[]; };  // units scattered, [layer][channel][cell], low words
layout(binding = 11, scalar) buffer Carries { uint carries[]; };    // high words
layout(binding = 12, scalar) buffer Counters { uint counters[]; };
layout(binding = 19, scalar) buffer Leaving { uint leaving[]; };  // units through each entry: low words, then high words
// Two a cut cell:
layout(binding = 13, scalar) buffer GammaS { vec3 gamma_s[]; };          // of the boundary condition, W/m^2
layout(binding = 14, scalar) buffer QueryGamma { vec3 query_gamma[]; };  // of the render query
layout(binding = 15, scalar) buffer Entered { vec3 entered[]; };         // all that enters
layout(binding = 16, scalar) buffer Near { vec4 near_light[]; };         // scattered in the facet's skin, W/m^2; mean cosine
layout(binding = 22, scalar) readonly buffer Starts { BeamStart starts[]; };
layout(binding = 23, scalar) readonly buffer StartsOf { uvec2 starts_of[]; };  // first and count
layout(binding = 24, scalar) readonly buffer Sides { uint sides[]; };          // 2 * cut cell + side

const int counter_words = 3 * BEAM_COUNTERS;

uvec3 totals[BEAM_COUNTERS];  // of the beam under way
vec3 skin_sum, boundary_sum, leaving_sum;  // of the facet, units
float skin_cosine;

void lay_down(ivec3 cell, uvec3 units, int layer) {
  if (layer == BEAM_DEEP) totals[BEAM_IN_CELLS] += units;
  for (int c = 0; c < push.channels; ++c) {
    if (units[c] == 0) continue;
    const int z = cell.z + (c + layer * push.channels) * push.cells.z;
    const uint at = uint(cell.x + push.cells.x * (cell.y + push.cells.y * z));
    const uint old = atomicAdd(deposits[at], units[c]);
    if (old + units[c] < old) atomicAdd(carries[at], 1u);
  }
}

void count_totals() {
  for (int k = 0; k < BEAM_COUNTERS; ++k)
    for (int c = 0; c < push.channels; ++c) {
      const uint v = totals[k][c];
      if (v == 0) continue;
      const uint old = atomicAdd(counters[3 * k + c], v);
      if (old + v < old) atomicAdd(counters[counter_words + 3 * k + c], 1u);
      totals[k][c] = 0;
    }
}

// Leave unscattered by a facet of cut cell `index`, which looks along `normal`.
void leave(uint index, vec3 normal, uvec3 units) {
  totals[BEAM_THROUGH] += units;
  uint entry = 2 * index + uint(facet_class(normal) & 1);
  if (cut_cells[index].side[entry & 1].area <= 0) entry ^= 1;
  for (int c = 0; c < push.channels; ++c) {
    if (units[c] == 0) continue;
    const uint old = atomicAdd(leaving[3 * entry + c], units[c]);
    if (old + units[c] < old) atomicAdd(leaving[3 * (2 * uint(push.count) + entry) + c], 1u);
  }
}

uvec3 share_of(uvec3 units, vec3 share) { return min(units, uvec3(floor(vec3(units) * clamp(share, 0, 1) + 0.5))); }

struct Beam {
  uvec3 start, left;  // units
  vec3 depth;         // optical, since start
};

// Takes what is lost over `length` from the beam; returns the scattered part and counts the absorbed.
uvec3 lose(inout Beam b, Solid s, float length_) {
  b.depth += s.sigma_t * length_;
  const uvec3 now = min(b.left, uvec3(vec3(b.start) * exp(-b.depth)));
  const uvec3 lost = b.left - now, scattered = share_of(lost, s.albedo);
  b.left = now;
  totals[BEAM_ABSORBED] += lost - scattered;
  return scattered;
}

vec3 mean_place(Solid s, float length_) {  // of the losses over it, 0 to length
  return length_ * vec3(loss_place(s.sigma_t.x * length_), loss_place(s.sigma_t.y * length_), loss_place(s.sigma_t.z * length_));
}

// Where the beam entered.
struct Facet {
  uint index;  // of the cut cell
  vec3 origin, normal;  // h, from the grid's corner; outward
  float mu;             // refracted cosine
  float near, skin;     // h: BEAM_NEAR_DEPTH and skin_depth(), or less where the object is thinner
};

void drive_boundary(uvec3 units, vec3 depth, Facet f) {
  totals[BEAM_NEAR] += units;
  for (int c = 0; c < push.channels; ++c) {
    const float kap = media[f.index].kappa[c], z = depth[c] * push.h, power = float(units[c]);
    const float per_length = sqrt(media[f.index].sigma_a[c] / kap), cosh_ = buried_cosh(z, per_length);
    const float boundary = buried_boundary(z, per_length, kap, push.A, push.f_dt);
    boundary_sum[c] += power * boundary;
    leaving_sum[c] += power * (cosh_ - boundary);
  }
}

void light_skin(uvec3 units, Facet f) {
  for (int c = 0; c < push.channels; ++c) {
    skin_sum[c] += float(units[c]);
    skin_cosine += float(units[c]) * f.mu;
  }
}

// Of one layer of a cell's deposits.
struct Laid {
  uvec3 units;        // to lay down there
  uvec3 behind;       // lost behind the cell's centroid
  vec3 behind_depth;  // h, mean
};

// A cell on the way that still waits for its share of what the next one loses.
struct Node {
  ivec3 cell;
  bool open;
  float depth;  // of its centroid below the entry, h
  Laid deep, shallow;
};

Node node_of(ivec3 cell, bool open, float depth) {
  const Laid nothing = Laid(uvec3(0), uvec3(0), vec3(0));
  return Node(cell, open, depth, nothing, nothing);
}

void close_node(inout Node n) {
  const uvec3 shallow = n.shallow.units + n.shallow.behind;
  if (n.open) lay_down(n.cell, n.deep.units + n.deep.behind, BEAM_DEEP);
  for (int once = n.open && shallow != uvec3(0) ? 1 : 0; once > 0; --once) lay_down(n.cell, shallow, BEAM_SHALLOW);
  n.open = false;
}

// Shares what was lost behind the centroid of the node before with the one that follows, `apart` from it.
void pass_on(inout Laid before, inout Laid here, float depth, float apart) {
  const uvec3 forward = share_of(before.behind, (before.behind_depth - depth) / apart);
  here.units += forward;
  before.behind -= forward;
}

// Of one cell's losses from w.at on.
struct Stretch {
  float from, to;  // along the way
  float apart;     // of the nodes, 0 where that is too little to tell depths by
  bool drives;     // the boundary condition, too
};

// What is lost over the stretch, in front of `depth` (the centroid's) and behind it.
void cross_layer(Stretch stretch, float depth, Solid s, Facet f, inout Beam beam, inout Laid before, inout Laid here) {
  const float middle = clamp(depth / f.mu, stretch.from, stretch.to);
  const vec3 front_depth = (stretch.from + mean_place(s, middle - stretch.from)) * f.mu;
  const uvec3 front = lose(beam, s, middle - stretch.from);
  const uvec3 back = stretch.apart > 0 ? share_of(front, (depth - front_depth) / stretch.apart) : uvec3(0);
  before.units += back;
  here.units += front - back;
  here.behind_depth = (middle + mean_place(s, stretch.to - middle)) * f.mu;
  here.behind = lose(beam, s, stretch.to - middle);
  for (int part = stretch.drives ? 0 : 2; part < 2; ++part)
    drive_boundary(part == 0 ? front : here.behind, part == 0 ? front_depth : here.behind_depth, f);
}

// The losses of one cell from w.at to `end`, by depth: in the skin, shallow, deep. `direct`: no mirror yet. What stands in a loop
// of one turn a CPU's lanes leave out where none needs it; what stands in an `if` they would run.
void cross_cell(Way w, float end, Solid s, Facet f, bool direct, inout Beam beam, inout Node node) {
  const vec3 middle = vec3(w.cell) + cut_cells[imageLoad(cut_index, w.cell).r].centre;
  Node here = node_of(w.cell, true, dot(f.origin - middle, f.normal));
  float apart = direct && node.open ? here.depth - node.depth : 0;
  if (apart < 0.2) apart = 0;
  if (apart > 0) pass_on(node.deep, here.deep, node.depth, apart);
  float at = w.at;
  const bool waits = node.open && node.shallow.behind != uvec3(0);
  for (int once = direct && (waits || at * f.mu < f.near) ? 1 : 0; once > 0; --once) {
    if (apart > 0) pass_on(node.shallow, here.shallow, node.depth, apart);
    const float skin = clamp(f.skin / f.mu, at, end);
    const vec3 depth = (at + mean_place(s, skin - at)) * f.mu;
    const uvec3 lost = lose(beam, s, skin - at);
    drive_boundary(lost, depth, f);
    light_skin(lost, f);
    at = clamp(f.near / f.mu, skin, end);
    cross_layer(Stretch(skin, at, apart, true), here.depth, s, f, beam, node.shallow, here.shallow);
  }
  const float depth = direct ? here.depth : nowhere;  // of a mirrored beam all lies where it is lost
  cross_layer(Stretch(at, end, apart, false), depth, s, f, beam, node.deep, here.deep);
  close_node(node);
  node = here;
}

// Lays the rest of a spent beam down, one more mean free path on.
void spend(Solid s, float at, Facet f, bool direct, inout Beam beam, inout Node node) {
  const uvec3 scattered = share_of(beam.left, s.albedo);
  totals[BEAM_ABSORBED] += beam.left - scattered;
  const float depth = direct ? at * f.mu : nowhere;
  for (int once = depth < f.near ? 1 : 0; once > 0; --once)
    drive_boundary(scattered, min((at + 1 / max(s.sigma_t, vec3(1e-6))) * f.mu, vec3(f.near)), f);
  if (depth < f.skin)
    light_skin(scattered, f);
  else if (depth < f.near)
    node.shallow.units += scattered;
  else
    node.deep.units += scattered;
  beam.left = uvec3(0);
}

void march(Facet f, ivec3 cell, vec3 along, uvec3 units) {
  Way w = way_from(f.origin, along, cell);
  Beam beam = Beam(units, units, vec3(0));
  Node node = node_of(cell, false, 0);
  int mirrors = 0;
  bool inside = false;
  uint last = f.index;  // cut cell on the way
  const int most_steps = BEAM_MOST_STEPS * (push.cells.x + push.cells.y + push.cells.z);
  for (int n = 0; n < most_steps; ++n) {
    const Solid s = solid_at(w.cell);
    if (!s.there) {
      if (inside || w.at > 2) break;
      step_on(w);
      continue;
    }
    inside = true;
    vec3 normal;
    float end = cell_end(w);
    const uint cut = imageLoad(cut_index, w.cell).r;
    if (cut != 0) last = cut;
    const float out_at = leaves_at(w, cut, end, normal);
    // Where its cell's facet is bent the beam starts beside the facet's plane, which is no end then.
    const bool leaves = out_at <= end && (out_at > 0.25 || mirrors > 0 || cut != f.index || dot(normal, f.normal) <= 0);
    if (leaves) end = out_at;
    cross_cell(w, end, s, f, mirrors == 0, beam, node);
    const bool spent = all(lessThanEqual(beam.left * BEAM_LEAST_SHARE, units));
    for (int once = spent ? 1 : 0; once > 0; --once) spend(s, end, f, mirrors == 0, beam, node);
    if (spent) break;
    if (!leaves) {
      step_on(w);
      continue;
    }
    const float cosine = dot(normal, w.along);
    uvec3 mirrored = share_of(beam.left, vec3(fresnel_reflectance(cosine, 1 / push.eta)));
    if (mirrors == BEAM_MOST_REFLECTIONS) mirrored = uvec3(0);
    leave(cut, normal, beam.left - mirrored);
    close_node(node);
    beam = Beam(mirrored, mirrored, vec3(0));
    if (mirrored == uvec3(0)) break;
    ++mirrors;
    w = way_from(w.from + end * w.along, normalize(w.along - 2 * cosine * normal), w.cell);
  }
  close_node(node);
  leave(last, w.along, beam.left);  // fell out where the surface is bent
}

// How deep the near light may reach: where the object is thinner than that, to the cell's centroid.
float near_of(GpuFacet side, vec3 origin, vec3 normal) {
  const bool deep = solid_at(ivec3(floor(origin - 1.25 * normal))).there && solid_at(ivec3(floor(origin - 0.75 * normal))).there;
  return deep ? BEAM_NEAR_DEPTH : min(side.distance, BEAM_NEAR_DEPTH);
}

// Surfaces and the environment light all of a facet alike: the samples are shared out among its starts, by their areas.
bool starts_here(uint beam, uvec2 of, uint own) {
  float all = 0, before = 0;
  for (uint k = 0; k < of.y; ++k) {
    if (k == own) before = all;
    all += starts[of.x + k].area;
  }
  const float place = all * fract((float(beam) + 0.5) * 0.61803399);
  return (own == 0 || place >= before) && (own + 1 == of.y || place < before + starts[of.x + own].area);
}

// The samples that go as one beam.
struct Bundle {
  vec3 flux;     // W/m^2, of all
  vec3 way;      // towards them: the mean of a lamp's, of surfaces the brightest
  float cosine;  // mean
  float most;    // light of the brightest
};

void add_to(inout Bundle b, Arrival light, bool lamp) {
  const float bright = light.flux.r + light.flux.g + light.flux.b;
  b.flux += light.flux;
  b.cosine += bright * light.cosine;
  if (lamp || bright > b.most) b.way = (lamp ? b.way : vec3(0)) + bright * light.towards;
  b.most = max(b.most, bright);
}

// Along its way, with its cosine.
Arrival arrival_of(Bundle b, vec3 normal, bool lamp) {
  const float all = b.flux.r + b.flux.g + b.flux.b, size = length(b.way);
  Arrival light = Arrival(b.way / max(size, 1e-30), b.cosine / max(all, 1e-30), b.flux);
  const float here = dot(normal, light.towards);
  if (lamp || size <= 0) {
    light.cosine = here;
  } else {
    const vec3 aside = light.towards - here * normal;
    light.towards = light.cosine * normal + sqrt(max(0, 1 - light.cosine * light.cosine)) / max(length(aside), 1e-6) * aside;
  }
  return light;
}

void light_side(uint at) {
  const uint index = at / 2;
  const GpuFacet side = cut_cells[index].side[at % 2];
  const uvec2 of = starts_of[at];
  const BeamStart start = starts[of.x + push.round];
  const Receiver around = receivers[at],
                 receiver = Receiver(push.origin + push.h * start.position, start.normal, start.slack);
  const ivec3 own = cut_cells[index].cell;
  Facet f = Facet(index, start.position, start.normal, 0, 0, 0);
  // What a neighbour gave lies in that neighbour's cell.
  const bool given = any(greaterThan(abs(start.position - vec3(own) - 0.5), vec3(0.51)));
  const ivec3 cell = given ? ivec3(floor(f.origin - 1e-3 * f.normal)) : own;
  const vec3 sigma_t = solid_at(own).sigma_t;  // 0 in channels that are not there
  const float thickness = (sigma_t.r + sigma_t.g + sigma_t.b) / float(push.channels);
  const Sky sky = sky_over(at, around, push.eta, push.f_dt_outer);
  const float area = side.area * push.h * push.h;
  vec3 all = vec3(0);
  skin_sum = boundary_sum = leaving_sum = vec3(0);
  skin_cosine = 0;
  const bool lamp = push.first < lighting.points;  // no part has both
  const uint end = min(push.end, arrivals());
  for (uint i = push.first; i < end; i += push.group) {
    Bundle bundle = Bundle(vec3(0), vec3(0), 0, 0);
    if (lamp || starts_here((i - lighting.points) / push.group, of, push.round))
      for (uint k = i; k < min(i + push.group, end); ++k)
        add_to(bundle, lamp ? point_arrival(points[k], receiver, push.eta) : arrival(k, around, push.eta, sky), lamp);
    f.normal = lamp ? receiver.normal : around.normal;
    Arrival light = arrival_of(bundle, f.normal, lamp);
    light.flux *= lamp ? start.area / side.area : 1;
    all += light.flux;
    uvec3 units = uvec3(0);
    for (int c = 0; c < push.channels; ++c)
      if (push.unit[c] > 0) units[c] = uint(min(floor(light.flux[c] * area / push.unit[c] + 0.5), BEAM_MOST_UNITS));
    if (units == uvec3(0)) continue;
    f.mu = max(refracted_cosine(light.cosine, push.eta), 1e-4);
    f.near = near_of(side, f.origin, f.normal);
    f.skin = min(f.near, skin_depth(thickness / f.mu, push.skin));
    totals[BEAM_ENTERED] += units;
    march(f, cell, normalize((light.cosine * f.normal - light.towards) / push.eta - f.mu * f.normal), units);
  }
  count_totals();
  const vec3 flux = push.unit / area;
  for (int c = 0; c < push.channels; ++c) {  // the mean cosine is weighted with units
    if (flux[c] <= 0) continue;
    skin_sum[c] += near_light[at][c] / flux[c];
    skin_cosine += near_light[at][c] / flux[c] * near_light[at].a;
  }
  const float skin_power = skin_sum.x + skin_sum.y + skin_sum.z;
  gamma_s[at] += boundary_sum * flux;
  query_gamma[at] += (boundary_sum - push.A * leaving_sum) * flux;
  near_light[at] = vec4(skin_sum * flux, skin_power > 0 ? skin_cosine / skin_power : 1);
  entered[at] += all;
}

void main() {
  if (gl_GlobalInvocationID.x >= push.listed) return;
  for (int k = 0; k < BEAM_COUNTERS; ++k) totals[k] = uvec3(0);
  light_side(sides[push.listed_first + gl_GlobalInvocationID.x]);
}
