// What mirrored rays bring: needs lighting/gather.glsl, lighting/ray_tree.glsl and the push block of reflection.comp; takes
// bindings 13 to 17.
#include "domain/facet_class.glsl"
#include "shared/reflection.h"
#include "shared/rough.h"
#include "lighting/environment.glsl"

// Lavapipe runs what a scene has no use for, too, unless it is left out.
layout(constant_id = 1) const int rough = 1;  // 0: no object of the scene is
layout(constant_id = 2) const int sky = 1;    // 0: its environment has no uniform part
layout(binding = 13, scalar) readonly buffer Objects { MirroredObject objects[]; };
layout(binding = 14) uniform sampler3D glow;                               // of all objects, glow.comp
layout(binding = 17, scalar) readonly buffer Emitters { Emitter emitters[]; };
layout(binding = 16, scalar) readonly buffer Lobes { float lobes[]; };     // rough_entries of each object

// W/m^2/sr.
struct Mirrored {
  vec3 surface;   // never entered a translucent object
  vec3 multiple;  // came out of one
};

Mirrored add(Mirrored a, Mirrored b, float share) {
  return Mirrored(a.surface + share * b.surface, a.multiple + share * b.multiple);
}

// The surface's own axes, z its normal (T. Duff et al., "Building an Orthonormal Basis, Revisited", 2017).
struct Frame {
  vec3 x, y, z;
};
Frame frame_of(vec3 n) {
  const float s = n.z >= 0 ? 1 : -1, a = -1 / (s + n.z), b = n.x * n.y * a;
  return Frame(vec3(1 + s * n.x * n.x * a, s * b, -s * n.x), vec3(b, s + n.y * n.y * a, -n.y), n);
}
vec3 into(Frame f, vec3 v) { return vec3(dot(f.x, v), dot(f.y, v), dot(f.z, v)); }
vec3 out_of(Frame f, vec3 v) { return f.x * v.x + f.y * v.y + f.z * v.z; }

// Point `index` of an even sequence in the unit cube (M. Roberts, "The Unreasonable Effectiveness of Quasirandom
// Sequences", 2018), turned by the pixel's own shift (pcg3d: M. Jarzynski, M. Olano, "Hash Functions for GPU Rendering",
// 2020), lest all pixels err alike.
vec3 spread(vec3 turn, uint index) {
  return fract(turn + float(index + 1) * vec3(0.8191725134, 0.6710436067, 0.5497004779));
}
vec3 turn_of(uvec2 pixel) {
  uvec3 v = uvec3(pixel, 0x9e3779b9u) * 1664525u + 1013904223u;
  v.x += v.y * v.z, v.y += v.z * v.x, v.z += v.x * v.y;
  v ^= v >> 16u;
  v.x += v.y * v.z, v.y += v.z * v.x, v.z += v.x * v.y;
  return vec3(v >> 8u) * (1 / 16777216.0);
}

RoughView rough_view_of(uint object, float mu, float eta) {
  const float at = sqrt(clamp(mu, 0, 1)) * (rough_entries - 1);
  const int k = min(int(at), rough_entries - 2);
  const uint first = object * rough_entries + k;
  return rough_view(mix(lobes[first], lobes[first + 1], at - k), fresnel_reflectance(mu, eta));
}

// (f n.i, density of picking i), 1/sr.
vec2 lobe_of(uint index, MirroredObject object, vec3 o, vec3 i, RoughView view) {
  const float deficit = rough_view_of(index, i.z, object.eta).deficit;
  return rough_value_and_density(o, i, object.alpha, object.eta, view, deficit, object.mean_deficit);
}

vec3 glow_of(MirroredObject object, vec3 position, vec3 normal) {
  const vec3 texel = clamp((position - object.grid_low) * object.per_metre, vec3(0.5), object.grid_cells - 0.5);
  const float z = object.glow_z[facet_class(normal) & 1];
  const vec3 radiance = texture(glow, (texel + vec3(0, 0, z)) / vec3(textureSize(glow, 0))).rgb;
  return object.glow_z.x < 0 ? vec3(0) : max(radiance, vec3(0));
}

// A point on an area light, picked in proportion to power.
struct LightRay {
  vec3 direction;
  float distance;  // m
  vec3 radiance;
  float density;   // 1/sr; 0: the light's dark side
};
LightRay towards_light(vec3 position, vec3 random, uint count) {
  uint low = 0, high = count;
  while (high - low > 1) {
    const uint middle = (low + high) / 2;
    if (emitters[middle].below <= random.x) low = middle; else high = middle;
  }
  const Emitter e = emitters[low];
  const MirroredObject object = objects[e.object];
  const float root = sqrt(random.y);
  const vec3 way = e.corner + root * ((1 - random.z) * e.edge1 + random.z * e.edge2) - position;
  const float distance2 = max(dot(way, way), 1e-30);
  LightRay ray;
  ray.distance = sqrt(distance2);
  ray.direction = way / ray.distance;
  const float front = -dot(normalize(cross(e.edge1, e.edge2)), ray.direction);
  const float cosine = object.two_sided != 0 ? abs(front) : front;
  ray.radiance = object.colour;
  ray.density = cosine > 0 ? object.light_density * distance2 / cosine : 0;
  return ray;
}

bool reaches(vec3 from, LightRay light) {
  return trace_ray(from, light.direction, 0, light.distance * (1 - 1e-4)).triangle == ray_missed;
}

// Which of the light points a ray asks where it meets an opaque surface: points first, first + stride, ..., each for
// `stride` of them. The rays of one pixel ask different ones, so that together they have asked all.
struct LightShare {
  uint first, stride;
};
LightShare asked_of(uint sample_, uint samples) {
  const uint least = 8;  // points a ray asks
  const uint stride = clamp(lighting.points / least, 1, samples);
  return LightShare(sample_ % stride, stride);
}
vec3 irradiance(vec3 position, vec3 normal, LightShare lights) {
  const vec3 sum = lights.stride * gather_points(position, normal, 0, 1, lights.first, lights.stride);
  if (sky == 0) return sum;
  return sum + lighting.environment * (3.14159265358979 * environment_openness(position, normal, 0, 1));
}

// A ray that leaves a surface with `throughput`; `density`, 1/sr, is that of its direction where lights are looked for,
// too, else 0.
struct Leaving {
  vec3 origin, direction;
  float throughput, density;
};
// Mirrorings beyond `orders` see the environment.
Mirrored follow(Leaving leaving, LightShare lights, uint orders, vec3 random) {
  vec3 origin = leaving.origin, direction = leaving.direction;
  float throughput = leaving.throughput;
  Mirrored sum = Mirrored(vec3(0), vec3(0));
  vec3 colour = vec3(0), position = vec3(0), normal = vec3(0);
  bool lambert = false;
  for (uint order = 0; throughput > 0; ++order) {
    if (order == orders) {
      sum.surface += throughput * environment_radiance(direction, push.environment_turn);
      break;
    }
    const RayHit hit = trace_ray(origin, direction, 0, 3e38);
    if (hit.triangle == ray_missed) {
      sum.surface += throughput * environment_radiance(direction, push.environment_turn);
      break;
    }
    const RayTriangle t = ray_triangle(hit.triangle);
    const MirroredObject object = objects[t.object];
    normal = normalize(cross(t.edge1, t.edge2));
    position = origin + hit.distance * direction;
    position -= dot(position - t.corner, normal) * normal;
    const float towards = -dot(normal, direction);
    if (object.kind == mirrored_emissive) {
      const float light = object.light_density * hit.distance * hit.distance / max(abs(towards), 1e-6);
      const float share = order == 0 && leaving.density > 0 ? leaving.density / (leaving.density + light) : 1;
      if (towards > 0 || object.two_sided != 0) sum.surface += throughput * share * object.colour;
      break;
    }
    if (object.kind == mirrored_opaque) {
      lambert = true;
      colour = throughput * 0.318309886 * object.colour;
      if (towards < 0) normal = -normal;
      break;
    }
    const float reflectance = fresnel_reflectance(towards, object.eta);
    sum.multiple += throughput * (1 - reflectance) * glow_of(object, position, normal);
    throughput *= reflectance;
    if (rough == 0 || object.alpha == 0) {
      direction = reflect(direction, normal);
    } else {
      const Frame frame = frame_of(normal);
      const vec3 o = into(frame, -direction);
      const RoughView view = rough_view_of(t.object, o.z, object.eta);
      const vec3 i = rough_direction(o, object.alpha, view, random);
      if (i.z <= 0) break;
      const vec2 lobe = lobe_of(t.object, object, o, i, view);
      throughput *= lobe.x / (lobe.y * max(reflectance, 1e-6));
      direction = out_of(frame, i);
    }
    origin = position;
    random = random.zxy;
  }
  if (lambert) sum.surface += colour * irradiance(position, normal, lights);
  return sum;
}
