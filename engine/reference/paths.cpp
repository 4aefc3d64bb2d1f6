#include "reference/paths.h"

#include <algorithm>

#include "reference/tracer.h"
#include "shared/optics.h"

namespace alabaster {
namespace {

constexpr float roulette_below = 0.25f;  // throughput under which a path is put to chance
constexpr float roulette_level = 0.5f;   // throughput of the survivors

void attenuate(Path& path, glm::vec3 sigma_t, float distance, bool grey) {
  if (grey) return;
  const glm::vec3 ratio = glm::exp((sigma_t[path.hero] - sigma_t) * distance);
  path.throughput *= ratio;
  path.densities *= ratio;
}
// A real collision: density sigma_t of each channel, and what scatters on.
void collide(Path& path, const Optics& optics) {
  const float own = optics.sigma_t[path.hero];
  path.throughput *= optics.sigma_s / own;
  path.densities *= optics.sigma_t / own;
}

}  // namespace

PathSample Tracer::trace(glm::vec3 origin, glm::vec3 direction, const Inside& inside) {
  Path path;
  path.origin = origin;
  path.direction = direction;
  path.inside = inside;
  path.hero = std::min(2, static_cast<int>(3 * random_.uniform()));
  path.entries = inside.empty() ? 0 : 1;
  path.first_translucent = path.entries > 0;
  follow(path);
  if (has_mirrored_) {
    has_mirrored_ = false;
    follow(mirrored_);
  }
  return sample_;
}

void Tracer::follow(Path& path) {
  for (;;) {
    if (++sample_.events > most_events) {
      sample_.capped = true;
      return;
    }
    Hit hit;
    switch (advance(path, hit)) {
      case Event::escape:
        sample_.leaks += !path.inside.empty();
        shine_from_sky(path);
        return;
      case Event::collision:
        if (!scatter(path)) return;
        break;
      case Event::surface:
        if (!meet(path, hit)) return;
        break;
    }
  }
}

bool Tracer::roulette(Path& path) {
  const float densities = path.densities.x + path.densities.y + path.densities.z;
  if (3 * largest(path.throughput) >= roulette_below * densities) return true;
  const float w = largest(path.weight());
  const float survive = w / roulette_level;
  if (!(random_.uniform() < survive)) return false;
  path.throughput /= survive;
  return true;
}

Tracer::Event Tracer::advance(Path& path, Hit& hit) {
  const FlatMedium* medium = medium_of(path.inside);
  if (!medium) {
    const bool met = cast(path, INFINITY, hit);
    meet_lamps(path, met ? hit.distance : INFINITY);
    return met ? Event::surface : Event::escape;
  }
  return medium->varies() ? advance_in_grid(path, *medium, hit) : advance_in_homogeneous(path, *medium, hit);
}

// Free flight in closed form, in the path's own channel.
Tracer::Event Tracer::advance_in_homogeneous(Path& path, const FlatMedium& medium, Hit& hit) {
  const Optics& optics = medium.homogeneous();
  const float flight = random_.exponential() * medium.mean_free_path()[path.hero];
  if (flight >= free_distance(path)) {
    if (!path.on_surface) renew_ball(path);
    if (flight >= free_distance(path)) {
      if (cast(path, flight, hit)) {
        attenuate(path, optics.sigma_t, hit.distance, medium.grey_flight());
        return Event::surface;
      }
      // Rounding can put a path that started on a surface's edge outside: let it go.
      if (world_.surely_outside(path.inside.top(), path.origin + flight * path.direction)) return Event::escape;
    }
  }
  move(path, flight);
  attenuate(path, optics.sigma_t, flight, medium.grey_flight());
  path.throughput *= medium.scattered(path.hero);
  path.densities *= medium.density(path.hero);
  return Event::collision;
}

// Delta tracking against a majorant common to the channels.
Tracer::Event Tracer::advance_in_grid(Path& path, const FlatMedium& medium, Hit& hit) {
  Candidates candidates(medium, path.origin, path.direction, random_);
  if (!path.on_surface) renew_ball(path);
  float limit = path.on_surface ? 0.0f : std::max(0.0f, path.ball_radius);
  bool cast_done = false;
  for (;;) {
    if (!candidates.next(limit)) {
      if (cast_done) return hit.where.object == nothing ? Event::escape : Event::surface;
      cast_done = true;
      limit = cast(path, INFINITY, hit) ? hit.distance : INFINITY;
      continue;
    }
    const Optics optics = medium.at(path.origin + candidates.distance() * path.direction);
    const float majorant = candidates.majorant(), own = optics.sigma_t[path.hero];
    if (random_.uniform() * majorant < own) {
      move(path, candidates.distance());
      collide(path, optics);
      return Event::collision;
    }
    if (medium.grey_flight()) continue;
    const glm::vec3 null = (majorant - optics.sigma_t) / (majorant - own);
    path.throughput *= null;
    path.densities *= null;
  }
}

bool Tracer::scatter(Path& path) {
  ++path.scatterings;
  const float g = world_.body(path.inside.top()).medium.g();
  const glm::vec3 before = path.direction;
  see_lights(path, {before, g, false});
  if (!roulette(path)) return false;
  const float cosine = phase_cosine(g, random_.uniform());
  path.direction = g == 0 ? from_axis(cosine, random_.uniform()) : around(before, cosine, random_.uniform());
  path.direction_density = path.sight == Path::Sight::none ? 0.0f : phase_value(g, cosine);
  path.vertex_direction = path.direction;
  return true;
}

bool Tracer::meet(Path& path, const Hit& hit) {
  const Body& body = world_.body(hit.where.object);
  const bool first = !path.met_surface;
  path.met_surface = true;
  path.origin = hit.point;
  path.on_surface = true;
  path.ball_radius = 0;
  if (body.role == Role::translucent) {
    if (first) sample_.on_object = path.first_translucent = true;
    path.leaving = {};
    return cross(path, hit, first);
  }
  if (body.role == Role::emissive) {
    shine(path, hit, body);
    return false;
  }
  path.leaving = hit.where;
  return reflect_diffusely(path, hit, body);
}

// What a surface of normal `n` mirrors, given that it does not let through: from outside a rough one spreads it. False
// where that leads into the surface.
bool Tracer::mirror(Path& path, const Body& body, bool entering, glm::vec3 n, float cosine) {
  if (!entering || !body.rough) {
    path.direction = glm::normalize(path.direction + 2 * cosine * n);
    return true;
  }
  const glm::vec3 x = around(n, 0, 0), y = glm::cross(n, x), back = -path.direction;
  const glm::vec3 o(glm::dot(x, back), glm::dot(y, back), std::max(cosine, 1e-4f));
  const float u = random_.uniform(), v = random_.uniform(), w = random_.uniform();
  const glm::vec3 i = body.rough->mirrored(o, {u, v, w});
  if (i.z <= 0) return false;
  const glm::vec2 lobe = body.rough->value_and_density(o, i);
  path.throughput *= lobe.x / (lobe.y * body.rough->view(o.z).reflectance);
  path.direction = glm::normalize(i.x * x + i.y * y + i.z * n);
  return true;
}

// A dielectric surface: mirrored or let through by chance, but both where the camera looks at it.
bool Tracer::cross(Path& path, const Hit& hit, bool first) {
  const std::uint32_t object = hit.where.object;
  const bool entering = glm::dot(path.direction, hit.normal) < 0;
  Inside beyond = path.inside;
  if (entering)
    beyond.push(object);
  else
    beyond.remove(object);
  const float ratio = world_.index_in(beyond) / world_.index_in(path.inside);
  if (ratio == 1) {
    path.entries += entering;
    path.inside = beyond;
    return true;
  }
  if (path.sight == Path::Sight::straight) path.sight = Path::Sight::none;
  const glm::vec3 n = entering ? hit.normal : -hit.normal;
  const float cosine = std::clamp(-glm::dot(path.direction, n), 0.0f, 1.0f);
  const float reflectance = fresnel_reflectance(cosine, ratio);
  const Body& body = world_.body(object);
  if (first && reflectance < 1) {
    mirrored_ = path;
    mirrored_.throughput *= reflectance;
    mirrored_.mirrored_first = entering;
    has_mirrored_ = reflectance > 0 && mirror(mirrored_, body, entering, n, cosine);
    path.throughput *= 1 - reflectance;
  } else if (random_.uniform() < reflectance) {
    if (first) path.mirrored_first = entering;
    return mirror(path, body, entering, n, cosine);
  }
  const float below = refracted_cosine(cosine, ratio);
  path.direction = glm::normalize((path.direction + cosine * n) / ratio - below * n);
  path.inside = beyond;
  path.entries += entering;
  return true;
}

bool Tracer::reflect_diffusely(Path& path, const Hit& hit, const Body& body) {
  const glm::vec3 n = glm::dot(path.direction, hit.normal) < 0 ? hit.normal : -hit.normal;
  path.throughput *= body.albedo;
  see_lights(path, {n, 0, true});
  if (!roulette(path)) return false;
  const float cosine = std::sqrt(1 - random_.uniform());
  path.direction = around(n, cosine, random_.uniform());
  path.direction_density = cosine / pi;
  path.vertex_direction = path.direction;
  return true;
}

PathSample trace_path(const World& world, glm::vec3 origin, glm::vec3 direction, const Inside& camera_inside,
                      Random& random) {
  return Tracer(world, random).trace(origin, direction, camera_inside);
}

}  // namespace alabaster
