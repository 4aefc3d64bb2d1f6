// What leaves a point of the surface in one direction after one scattering (shared/single.h). Takes bindings 0 to 2 and 11 to 18.
#include "lighting/gather.glsl"
#include "lighting/ray_tree.glsl"
#include "shared/domain.h"
#include "shared/single.h"
layout(binding = 13, scalar) uniform Grid { SingleGrid grid; };
layout(binding = 14, r32ui) uniform readonly uimage3D cut_index;
layout(binding = 15, scalar) readonly buffer CutCells { GpuCutCell cut_cells[]; };
layout(binding = 16, rgba32f) uniform readonly image3D volume;
layout(binding = 17, rgba32f) uniform readonly image3D kappa;
layout(binding = 18, rgba32f) uniform readonly image3D absorption;
#define GRID grid
#include "domain/way.glsl"

// Coefficients as they are, 1/m: the solver's are reduced.
struct Optics {
  vec3 sigma_t, albedo;
};

Optics optics_of(vec3 sigma_s, vec3 sigma_a) {
  const vec3 sigma_t = max(sigma_s + sigma_a, vec3(1e-20));
  return Optics(sigma_t, sigma_s / sigma_t);
}

Optics optics_in(Solid s) {
  if (grid.channels == 1) s.sigma_t = s.sigma_t.rrr, s.albedo = s.albedo.rrr;
  const vec3 reduced = s.sigma_t / grid.h;
  return optics_of(s.albedo * reduced / (1 - grid.g), (1 - s.albedo) * reduced);
}

vec3 to_grid(vec3 position) { return (position - grid.origin) / grid.h; }

// The medium at a place in or near the object; `otherwise` where its cell is empty.
Optics optics_at(vec3 position, Optics otherwise) {
  if (grid.varies == 0) return otherwise;
  const Solid s = solid_at(ivec3(floor(to_grid(position))));
  return s.there ? optics_in(s) : otherwise;
}

// Of a straight way inside the object; empty cells on it, which only the mesh's bends make, are like `otherwise`.
vec3 optical_depth(vec3 from, vec3 along, float distance_, Optics otherwise) {
  if (grid.varies == 0) return otherwise.sigma_t * distance_;
  const float end = distance_ / grid.h;
  const int most_steps = grid.cells.x + grid.cells.y + grid.cells.z;
  Way w = way_from(to_grid(from), along, ivec3(floor(to_grid(from))));
  vec3 depth = vec3(0);
  for (int n = 0; n < most_steps && w.at < end; ++n) {
    const Solid s = solid_at(w.cell);
    if (s.there) otherwise = optics_in(s);
    depth += otherwise.sigma_t * (max(min(cell_end(w), end) - w.at, 0) * grid.h);
    step_on(w);
  }
  return depth;
}

struct Place {
  vec3 position;  // m
  float along;    // m, on the view ray
  vec3 depth;     // optical, of it
  Optics optics;
};

struct View {
  vec3 inwards;  // unit
  vec3 position, normal;
  float slack;   // m, of the position off the surface
  float far;     // m; what is farther is too deep
  bool ends;     // the ray leaves the object at the last place
  int count;
  Place places[SINGLE_PLACES_VARYING];
};

// The outermost place within `reach` (m) where a ray that comes to `position` against `towards` meets a surface, or none:
// all triangles are met from outside only.
RayHit comes_in(vec3 position, vec3 towards, float reach) { return trace_ray(position + reach * towards, -towards, 0, reach); }

// `outside` is where it leaves to, `cosine` its cosine with the normal.
View view_of(Receiver surface_place, vec3 outside, float cosine) {
  const vec3 normal = surface_place.normal;
  View v;
  v.position = surface_place.position;
  v.normal = normal;
  v.slack = surface_place.slack;
  v.inwards = normalize((cosine * normal - outside) / grid.eta - refracted_cosine(cosine, grid.eta) * normal);
  const Optics given = optics_of(grid.sigma_s, grid.sigma_a);
  const Optics here = optics_at(v.position - 0.25 * grid.h * normal, given);
  const float most = max(here.sigma_t.x, max(here.sigma_t.y, here.sigma_t.z)),
              least = min(here.sigma_t.x, min(here.sigma_t.y, here.sigma_t.z));
  v.count = grid.varies != 0 ? SINGLE_PLACES_VARYING : SINGLE_PLACES;
  v.far = SINGLE_DEEP / least;
  const RayHit end = comes_in(v.position, v.inwards, v.far);
  v.ends = end.triangle != ray_missed && ray_triangle(end.triangle).object == grid.object;
  const float nearest = 0.5 / most, last = 4 / least, chord = v.far - end.distance;
  const float scale = v.ends ? chord / last : 1;
  Optics optics = here;
  vec3 depth = vec3(0);
  float before = 0;
  for (int k = 0; k < v.count; ++k) {
    const float along = k == 0 ? 0 : scale * nearest * pow(last / nearest, float(k - 1) / float(v.count - 2));
    depth += optical_depth(v.position + before * v.inwards, v.inwards, along - before, optics);
    before = along;
    const vec3 position = v.position + along * v.inwards;
    optics = optics_at(position, optics);
    v.places[k] = Place(position, along, depth, optics);
  }
  return v;
}

// One light at one place: p F_t (cos / mu') E over the light's colour, and the optical depth of its way inside.
struct Light {
  float strength;
  vec3 depth;
  bool deep;  // too deep to be found
};

float lit_at(uint i, vec3 position, vec3 normal, float slack) {
  bool inside;
  if (i >= lighting.points)
    return look_up(lighting.first_view + i - lighting.points, position, normal, slack, inside);
  float lit = 1;
  for (uint v = 0; v < points[i].views; ++v) {
    lit = look_up(points[i].first_view + v, position, normal, slack, inside);
    if (inside) break;
  }
  return lit;
}

Light light_at(uint i, View v, int k) {
  Light light = Light(0, vec3(0), false);
  const Place place = v.places[k];
  vec3 towards;
  float strength = 1, reach = v.far;
  if (i < lighting.points) {
    const LightPoint lamp = points[i];
    float distance2;
    towards = way_to(lamp, place.position, distance2);
    strength = light_share(lamp.kind, -dot(lamp.normal, towards), lamp.cone.scale, lamp.cone.offset) / distance2;
    if (strength <= 0) return light;
    if (lamp.kind != light_directional) reach = min(reach, 0.99 * sqrt(distance2));
  } else {
    towards = environment_way(i - lighting.points);
  }
  vec3 entry = place.position, normal = v.normal;
  float way = 0, slack = v.slack;
  if (k > 0 || dot(towards, normal) <= 0) {
    const RayHit hit = comes_in(place.position, towards, reach);
    light.deep = hit.triangle == ray_missed;
    if (light.deep) return light;
    const RayTriangle met = ray_triangle(hit.triangle);
    if (met.object != grid.object) return light;
    normal = normalize(cross(met.edge1, met.edge2));
    way = reach - hit.distance;
    entry = place.position + way * towards;
    slack = 0;
  }
  const float cosine = dot(normal, towards), mu = refracted_cosine(cosine, grid.eta);
  if (cosine <= 0 || mu <= 0) return light;
  strength *= lit_at(i, entry, normal, slack);
  if (strength <= 0) return light;
  const vec3 refracted = normalize(towards / grid.eta + (mu - cosine / grid.eta) * normal);
  light.strength = strength * fresnel_transmittance(cosine, grid.eta) * cosine / mu *
                   henyey_greenstein(grid.g, dot(refracted, v.inwards));
  light.depth = optical_depth(place.position, towards, way, place.optics) * (cosine / mu);
  return light;
}

// Over F_t / eta^2 and the light's colour.
vec3 scattered(uint i, View v) {
  vec3 sum = vec3(0);
  Light before = light_at(i, v, 0);
  if (before.deep) return sum;  // from behind
  for (int k = 1; k < v.count; ++k) {
    const Place from = v.places[k - 1], to = v.places[k];
    Light light = light_at(i, v, k);
    if (light.deep) light.strength = before.strength, light.depth = before.depth + vec3(SINGLE_DEEP);
    const vec3 weight = 0.5 * (before.strength * from.optics.albedo + light.strength * to.optics.albedo);
    const vec3 d = to.depth - from.depth, a = from.depth + before.depth, b = to.depth + light.depth;
    for (int c = 0; c < 3; ++c) {
      sum[c] += weight[c] * d[c] * mean_exponential(a[c], b[c]);
      if (k == v.count - 1 && !v.ends && d[c] > 0)
        sum[c] += light.strength * to.optics.albedo[c] * exp(-b[c]) * d[c] / max(b[c] - a[c], 0.5 * d[c]);
    }
    before = light;
  }
  return sum;
}

// Irradiance across its way that stands for each of the uniform environment's directions: so that what enters through the
// surface here is pi L (1 - F_dr).
vec3 environment_weight(View v) {
  float all = 0;
  for (uint i = 0; i < lighting.directions; ++i) {
    const float cosine = dot(v.normal, environment_way(i));
    if (cosine > 0) all += cosine * fresnel_transmittance(cosine, grid.eta);
  }
  return all > 0 ? lighting.environment * (3.14159265358979 * grid.f_dt_outer / all) : vec3(0);
}

// Of the lights `first` to before `end`, W/m^2/sr over F_t / eta^2.
vec3 scattered_once(uint first, uint end, View v) {
  const vec3 environment = environment_weight(v);
  vec3 sum = vec3(0);
  for (uint i = first; i < end; ++i) sum += (i < lighting.points ? points[i].intensity : environment) * scattered(i, v);
  return sum;
}
