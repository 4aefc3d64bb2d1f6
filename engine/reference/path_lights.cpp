// Lights met and looked for: next-event estimation, guides through refracting surfaces, and their weights against
// chance.
#include <algorithm>

#include "reference/guide.h"
#include "reference/tracer.h"

namespace alabaster {
namespace {

// Over the transmittance so far: the chance that a look at a light goes on behind a surface.
constexpr float worth_going_on = 3;

}  // namespace

void Tracer::shine(Path& path, const Hit& hit, const Body& body) {
  const float cosine = -glm::dot(path.direction, hit.normal);
  if (cosine <= 0 && !body.two_sided) return;
  float share = 1;
  if (path.sight == Path::Sight::straight) {
    const glm::vec3 way = hit.point - path.vertex;
    const float light_density = body.light_density * glm::dot(way, way) / std::max(std::abs(cosine), 1e-6f);
    share = path.direction_density / (path.direction_density + light_density);
  } else if (path.sight == Path::Sight::guided) {
    const LightGuide guide(world_, path.vertex, path.vertex_inside, hit.where.object);
    share = path.direction_density / (path.direction_density + guide.density(path.vertex_direction));
  }
  collect(path, share * body.radiance);
}

// At the end of a path that leaves the scene.
void Tracer::shine_from_sky(const Path& path) {
  float share = 1;
  const float sky_density = path.sight == Path::Sight::none ? 0.0f : world_.sky_density(path.direction);
  if (sky_density > 0 && path.sight == Path::Sight::straight) {
    share = path.direction_density / (path.direction_density + sky_density);
  } else if (sky_density > 0) {
    const LightGuide guide(world_, path.vertex, path.vertex_inside, world_.sky_id(path.direction));
    share = path.direction_density / (path.direction_density + guide.density(path.vertex_direction));
  }
  collect(path, share * world_.sky(path.direction));
}

// Lamps outside all media that the path passes within `limit`. Looking for them straight has found all their light.
void Tracer::meet_lamps(const Path& path, float limit) {
  if (!path.scattered || path.sight == Path::Sight::straight) return;
  for (std::size_t i = 0; i < world_.lamps().size(); ++i) {
    const glm::vec3 seen = world_.lamps()[i].seen(path.origin, path.direction, limit);
    if (seen == glm::vec3(0)) continue;
    float share = 1;
    if (path.sight == Path::Sight::guided) {
      const LightGuide guide(world_, path.vertex, path.vertex_inside, world_.lamp_id(i));
      share = path.direction_density / (path.direction_density + guide.density(path.vertex_direction));
    }
    collect(path, share * seen);
  }
}

// Next-event estimation at the path's origin.
void Tracer::see_lights(Path& path, const Lobe& lobe) {
  path.scattered = true;
  path.sight = !world_.has_lights()         ? Path::Sight::none
               : !behind_glass(path.inside) ? Path::Sight::straight
               : world_.guided(path.inside) ? Path::Sight::guided
                                            : Path::Sight::none;
  if (path.sight == Path::Sight::none) return;
  path.vertex = path.origin;
  path.vertex_inside = path.inside;
  // Deep inside hardly any light arrives unscattered: ask seldom there, and count what arrives more.
  float asked = 1;
  if (!path.inside.empty() && !path.on_surface) {
    const float depth = world_.body(path.inside.top()).medium.least_sigma_t() * free_distance(path);
    asked = std::min(1.0f, 2 * std::exp(-depth));
    if (asked < 1 && random_.uniform() >= asked) return;
  }
  const LightPick light = world_.sample_light(random_);
  if (path.sight == Path::Sight::guided)
    see_guided(path,
               light.sky != nothing    ? world_.sky_id(light.sky)
               : light.lamp != nothing ? world_.lamp_id(light.lamp)
                                       : light.object,
               asked, lobe);
  else if (light.sky != nothing)
    see_sky(path, asked, lobe);
  else if (light.lamp != nothing)
    see_lamp(path, world_.lamps()[light.lamp], asked, lobe);
  else
    see_straight(path, light, asked, lobe);
}

void Tracer::see_straight(Path& path, const LightPick& light, float asked, const Lobe& lobe) {
  const Body& body = world_.body(light.object);
  const glm::vec3 way = light.point - path.origin;
  const float square = glm::dot(way, way), distance = std::sqrt(square);
  if (!(distance > 0)) return;
  const glm::vec3 towards = way / distance;
  const float cosine = -glm::dot(light.normal, towards);
  if (cosine == 0 || (cosine < 0 && !body.two_sided)) return;
  const float density = lobe.density(towards);
  if (density <= 0) return;
  const float light_density = body.light_density * square / std::abs(cosine);
  const glm::vec3 arrives = transmittance(path, towards, distance, light.object);
  collect(path, body.radiance * arrives * (density / ((light_density + density) * asked)));
}

void Tracer::see_sky(Path& path, float asked, const Lobe& lobe) {
  const glm::vec3 towards = world_.draw_sky(random_);
  const float density = lobe.density(towards), sky_density = world_.sky_density(towards);
  if (density <= 0 || sky_density <= 0) return;
  const glm::vec3 arrives = transmittance(path, towards, INFINITY, nothing);
  collect(path, world_.sky(towards) * arrives * (density / ((sky_density + density) * asked)));
}

void Tracer::see_lamp(const Path& path, const Lamp& lamp, float asked, const Lobe& lobe) {
  const Lamp::Arrival light = lamp.sample(path.origin, random_);
  if (light.irradiance == glm::vec3(0)) return;
  const float value = lobe.density(light.direction);
  if (value <= 0) return;
  const glm::vec3 arrives = transmittance(path, light.direction, light.distance, nothing);
  collect(path, light.irradiance * arrives * (value / (lamp.share * asked)));
}

// Where surfaces bend light: a direction towards the lamp's image, and whatever mirroring and refraction bring from
// there. Chance finds the same ways, with the lobe's density of their first direction.
void Tracer::see_guided(const Path& path, std::uint32_t light, float asked, const Lobe& lobe) {
  const LightGuide guide(world_, path.origin, path.inside, light);
  if (!guide.useful()) return;
  Path ray = path;
  ray.direction = guide.sample(random_);
  const float density = lobe.density(ray.direction);
  if (density <= 0) return;
  ray.throughput *= density / (asked * (guide.density(ray.direction) + density));
  ray.sight = Path::Sight::none;
  shoot(ray, light);
}

// Follows an unscattered way to a light (World::lamp_id), if that is where it leads.
void Tracer::shoot(Path& ray, std::uint32_t light) {
  const bool sky = light >= world_.sky_id(0u), lamp = !sky && light >= world_.lamp_id(0);
  while (++sample_.events <= most_events) {
    Hit hit;
    const bool met = cast(ray, INFINITY, hit);
    if (lamp && !medium_of(ray.inside))
      collect(ray,
              world_.lamps()[light - world_.lamp_id(0)].seen(ray.origin, ray.direction, met ? hit.distance : INFINITY));
    if (!met) {
      if (sky && ray.inside.empty() && world_.sky_id(ray.direction) == light) shine_from_sky(ray);
      return;
    }
    const Body& body = world_.body(hit.where.object);
    const bool arrived = hit.where.object == light;
    if (!arrived && body.role != Role::translucent) return;
    glm::vec3 left(1);
    if (!pass(ray.inside, ray.origin, ray.direction, hit.distance, left)) return;
    ray.throughput *= left;
    if (arrived) return shine(ray, hit, body);
    const float survive = worth_going_on * largest(left);
    if (survive < 1) {
      if (random_.uniform() >= survive) return;
      ray.throughput /= survive;
    }
    ray.origin = hit.point;
    ray.on_surface = true;
    ray.leaving = {};
    if (!cross(ray, hit, false)) return;
  }
  sample_.capped = true;
}

// Of the straight way to a point on light `target`; 0 where something else or a refracting surface is in between.
glm::vec3 Tracer::transmittance(const Path& path, glm::vec3 direction, float distance, std::uint32_t target) {
  Inside inside = path.inside;
  glm::vec3 origin = path.origin, result(1);
  float left = distance, back = path.on_surface ? world_.nudge() : 0.0f;
  Leaving leaving = path.leaving;
  for (int surfaces = 0; surfaces < 10000; ++surfaces) {
    Hit hit;
    const float far = left + back;
    const bool met = world_.next_surface(origin - back * direction, direction, far * (1 + 1e-5f), inside, leaving, hit);
    const float span = met ? std::clamp(hit.distance - back, 0.0f, left) : left;
    if (met && world_.body(hit.where.object).role != Role::translucent && hit.where.object != target)
      return glm::vec3(0);
    if (!met && distance == INFINITY && !inside.empty()) return glm::vec3(0);  // it leaked
    const bool arrived = !met || hit.where.object == target;
    if (arrived && met && span < left * (1 - 1e-3f)) return glm::vec3(0);  // the light's own other parts shade too
    if (!pass(inside, origin, direction, span, result)) return glm::vec3(0);
    if (arrived) return result;
    const float survive = worth_going_on * largest(result);  // what is left of little is seldom worth a ray more
    if (survive < 1) {
      if (random_.uniform() >= survive) return glm::vec3(0);
      result /= survive;
    }
    Inside beyond = inside;
    if (glm::dot(direction, hit.normal) < 0)
      beyond.push(hit.where.object);
    else
      beyond.remove(hit.where.object);
    if (world_.index_in(beyond) != world_.index_in(inside)) return glm::vec3(0);
    inside = beyond;
    origin = hit.point;
    left -= span;
    back = world_.nudge();
    leaving = {};
  }
  return glm::vec3(0);
}

// Multiplies `result` by the transmittance of a segment in one medium; false where nothing is left. Ratio tracking in
// grids (J. Novak et al., "Residual Ratio Tracking for Estimating Attenuation in Participating Media", 2014).
bool Tracer::pass(const Inside& inside, glm::vec3 origin, glm::vec3 direction, float distance, glm::vec3& result) {
  const FlatMedium* medium = medium_of(inside);
  if (!medium) return true;
  if (!medium->varies()) {
    result *= glm::exp(-medium->homogeneous().sigma_t * distance);
    return largest(result) > 0;
  }
  Candidates candidates(*medium, origin, direction, random_);
  while (candidates.next(distance)) {
    result *= 1.0f - medium->at(origin + candidates.distance() * direction).sigma_t / candidates.majorant();
    if (largest(result) < 0.1f) {
      if (random_.uniform() < 0.5f) return false;
      result *= 2.0f;
    }
  }
  return largest(result) > 0;
}

}  // namespace alabaster
