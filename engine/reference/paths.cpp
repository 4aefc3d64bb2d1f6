#include "reference/paths.h"

#include <algorithm>

#include "reference/guide.h"
#include "shared/optics.h"

namespace alabaster {
namespace {

constexpr float roulette_below = 0.25f;  // throughput under which a path is put to chance
constexpr float roulette_level = 0.5f;   // throughput of the survivors

struct Path {
  glm::vec3 origin{0}, direction{0};
  glm::vec3 throughput{1};  // per channel, over the density of the path as sampled by the channel `hero`
  glm::vec3 densities{1};   // density of the path, had each channel been the one that sampled it, over that of `hero`
  int hero = 0;
  Inside inside;
  bool on_surface = false;  // the origin lies on a surface
  Leaving leaving;
  // How the last vertex looked for the lights, for the balance heuristic: not at all (or a surface came since that
  // bends light), straight, or by a guide through such surfaces.
  enum class Sight { none, straight, guided } sight = Sight::none;
  Inside vertex_inside;
  glm::vec3 vertex{0}, vertex_direction{0};
  float direction_density = 0;  // 1/sr
  // Ball that holds no surface.
  glm::vec3 ball_centre{0};
  float ball_radius = 0;
  // For the layers.
  int scatterings = 0, entries = 0;
  bool scattered = false;  // in a medium or by an opaque surface
  bool met_surface = false, first_translucent = false, mirrored_first = false;

  glm::vec3 weight() const { return throughput * (3.0f / (densities.x + densities.y + densities.z)); }
  Layer layer() const {
    if (!first_translucent || entries == 0) return Layer::surface;
    return mirrored_first || entries > 1 || scatterings > 1 ? Layer::multiple : Layer::single;
  }
};

float largest(glm::vec3 v) { return std::max(v.x, std::max(v.y, v.z)); }

class Tracer {
 public:
  Tracer(const World& world, Random& random) : world_(world), random_(random) {}

  PathSample trace(glm::vec3 origin, glm::vec3 direction, const Inside& inside) {
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

 private:
  enum class Event { collision, surface, escape };

  void follow(Path& path) {
    for (;;) {
      if (++sample_.events > most_events) {
        sample_.capped = true;
        return;
      }
      Hit hit;
      switch (advance(path, hit)) {
        case Event::escape:
          sample_.leaks += !path.inside.empty();
          collect(path, world_.environment());
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

  const FlatMedium* medium_of(const Inside& inside) const {
    if (inside.empty()) return nullptr;
    const FlatMedium& medium = world_.body(inside.top()).medium;
    return medium.empty() ? nullptr : &medium;
  }

  void collect(const Path& path, glm::vec3 radiance) {
    const float n = world_.index_in(path.inside);
    sample_.radiance[static_cast<std::size_t>(path.layer())] += path.weight() * radiance / (n * n);
  }

  bool roulette(Path& path) {
    const float densities = path.densities.x + path.densities.y + path.densities.z;
    if (3 * largest(path.throughput) >= roulette_below * densities) return true;
    const float w = largest(path.weight());
    const float survive = w / roulette_level;
    if (!(random_.uniform() < survive)) return false;
    path.throughput /= survive;
    return true;
  }

  // Next surface within `far` of the path's origin; its distance is measured from there.
  bool cast(const Path& path, float far, Hit& hit) const {
    const float back = path.on_surface ? world_.nudge() : 0.0f;
    if (!world_.next_surface(path.origin - back * path.direction, path.direction, far + back, path.inside, path.leaving,
                             hit))
      return false;
    hit.distance = std::max(0.0f, hit.distance - back);
    return true;
  }

  // How far the path may go without asking for surfaces.
  float free_distance(Path& path) const {
    if (path.on_surface) return 0;
    const float moved = glm::length(path.origin - path.ball_centre);
    return path.ball_radius - moved;
  }
  void renew_ball(Path& path) const {
    path.ball_centre = path.origin;
    path.ball_radius = world_.clearance(path.inside.top(), path.origin);
  }

  void move(Path& path, float distance) {
    path.origin += distance * path.direction;
    path.on_surface = false;
    path.leaving = {};
  }

  Event advance(Path& path, Hit& hit) {
    const FlatMedium* medium = medium_of(path.inside);
    if (!medium) {
      const bool met = cast(path, INFINITY, hit);
      meet_lamps(path, met ? hit.distance : INFINITY);
      return met ? Event::surface : Event::escape;
    }
    return medium->gridded() ? advance_in_grid(path, *medium, hit) : advance_in_homogeneous(path, *medium, hit);
  }

  // Free flight in closed form, in the path's own channel.
  Event advance_in_homogeneous(Path& path, const FlatMedium& medium, Hit& hit) {
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

  static void attenuate(Path& path, glm::vec3 sigma_t, float distance, bool grey) {
    if (grey) return;
    const glm::vec3 ratio = glm::exp((sigma_t[path.hero] - sigma_t) * distance);
    path.throughput *= ratio;
    path.densities *= ratio;
  }
  // A real collision: density sigma_t of each channel, and what scatters on.
  static void collide(Path& path, const Optics& optics) {
    const float own = optics.sigma_t[path.hero];
    path.throughput *= optics.sigma_s / own;
    path.densities *= optics.sigma_t / own;
  }

  // Delta tracking against a majorant common to the channels.
  Event advance_in_grid(Path& path, const FlatMedium& medium, Hit& hit) {
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

  bool scatter(Path& path) {
    ++path.scatterings;
    const float g = world_.body(path.inside.top()).medium.g();
    const glm::vec3 before = path.direction;
    see_lights(path, [&](glm::vec3 towards) {
      const float value = phase_value(g, glm::dot(before, towards));
      return glm::vec2(value, value);
    });
    if (!roulette(path)) return false;
    const float cosine = phase_cosine(g, random_.uniform());
    path.direction = g == 0 ? from_axis(cosine, random_.uniform()) : around(before, cosine, random_.uniform());
    path.direction_density = path.sight == Path::Sight::none ? 0.0f : phase_value(g, cosine);
    path.vertex_direction = path.direction;
    return true;
  }

  bool meet(Path& path, const Hit& hit) {
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
  bool mirror(Path& path, const Body& body, bool entering, glm::vec3 n, float cosine) {
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
  bool cross(Path& path, const Hit& hit, bool first) {
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

  void shine(Path& path, const Hit& hit, const Body& body) {
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

  // Lamps outside all media that the path passes within `limit`. Looking for them straight has found all their light.
  void meet_lamps(const Path& path, float limit) {
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

  bool reflect_diffusely(Path& path, const Hit& hit, const Body& body) {
    const glm::vec3 n = glm::dot(path.direction, hit.normal) < 0 ? hit.normal : -hit.normal;
    path.throughput *= body.albedo;
    see_lights(path, [&](glm::vec3 towards) {
      const float density = std::max(0.0f, glm::dot(n, towards)) / pi;
      return glm::vec2(density, density);
    });
    if (!roulette(path)) return false;
    const float cosine = std::sqrt(1 - random_.uniform());
    path.direction = around(n, cosine, random_.uniform());
    path.direction_density = cosine / pi;
    path.vertex_direction = path.direction;
    return true;
  }

  // Next-event estimation at the path's origin. `lobe` gives (value, density) of a direction, 1/sr.
  template <class Lobe>
  void see_lights(Path& path, Lobe lobe) {
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
      see_guided(path, light.lamp == nothing ? light.object : world_.lamp_id(light.lamp), asked, lobe);
    else if (light.lamp != nothing)
      see_lamp(path, world_.lamps()[light.lamp], asked, lobe);
    else
      see_straight(path, light, asked, lobe);
  }

  template <class Lobe>
  void see_straight(Path& path, const LightPick& light, float asked, Lobe lobe) {
    const Body& body = world_.body(light.object);
    const glm::vec3 way = light.point - path.origin;
    const float square = glm::dot(way, way), distance = std::sqrt(square);
    if (!(distance > 0)) return;
    const glm::vec3 towards = way / distance;
    const float cosine = -glm::dot(light.normal, towards);
    if (cosine == 0 || (cosine < 0 && !body.two_sided)) return;
    const glm::vec2 value_density = lobe(towards);
    if (value_density.x <= 0) return;
    const float light_density = body.light_density * square / std::abs(cosine);
    const float share = light_density / (light_density + value_density.y);
    const glm::vec3 arrives = transmittance(path, towards, distance, light.object);
    const float n = world_.index_in(path.inside);
    sample_.radiance[static_cast<std::size_t>(path.layer())] +=
        path.weight() * body.radiance * arrives * (share * value_density.x / (light_density * asked * n * n));
  }

  template <class Lobe>
  void see_lamp(const Path& path, const Lamp& lamp, float asked, Lobe lobe) {
    const Lamp::Arrival light = lamp.sample(path.origin, random_);
    if (light.irradiance == glm::vec3(0)) return;
    const float value = lobe(light.direction).x;
    if (value <= 0) return;
    const float n = world_.index_in(path.inside);
    sample_.radiance[static_cast<std::size_t>(path.layer())] +=
        path.weight() * light.irradiance * transmittance(path, light.direction, light.distance, nothing) *
        (value / (lamp.share * asked * n * n));
  }

  // Where surfaces bend light: a direction towards the lamp's image, and whatever mirroring and refraction bring from
  // there. Chance finds the same ways, with the lobe's density of their first direction.
  template <class Lobe>
  void see_guided(const Path& path, std::uint32_t lamp, float asked, Lobe lobe) {
    const LightGuide guide(world_, path.origin, path.inside, lamp);
    if (!guide.useful()) return;
    Path ray = path;
    ray.direction = guide.sample(random_);
    const glm::vec2 value_density = lobe(ray.direction);
    if (value_density.x <= 0) return;
    ray.throughput *= value_density.x / (asked * (guide.density(ray.direction) + value_density.y));
    ray.sight = Path::Sight::none;
    shoot(ray, lamp);
  }

  // Follows an unscattered way to the light `lamp` (World::lamp_id), if that is where it leads.
  void shoot(Path& ray, std::uint32_t lamp) {
    while (++sample_.events <= most_events) {
      Hit hit;
      const bool met = cast(ray, INFINITY, hit);
      if (lamp >= world_.lamp_id(0) && !medium_of(ray.inside))
        collect(ray, world_.lamps()[lamp - world_.lamp_id(0)].seen(ray.origin, ray.direction,
                                                                   met ? hit.distance : INFINITY));
      if (!met) return;
      const Body& body = world_.body(hit.where.object);
      const bool arrived = hit.where.object == lamp;
      if (!arrived && body.role != Role::translucent) return;
      glm::vec3 left(1);
      if (!pass(ray.inside, ray.origin, ray.direction, hit.distance, left)) return;
      ray.throughput *= left;
      if (arrived) return shine(ray, hit, body);
      const float survive = 3 * largest(left);
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

  // Surfaces of another index bend light: nothing is seen straight through them.
  bool behind_glass(const Inside& inside) const { return world_.index_in(inside) != 1; }

  // Of the straight way to a point on light `target`; 0 where something else or a refracting surface is in between.
  glm::vec3 transmittance(const Path& path, glm::vec3 direction, float distance, std::uint32_t target) {
    Inside inside = path.inside;
    glm::vec3 origin = path.origin, result(1);
    float left = distance, back = path.on_surface ? world_.nudge() : 0.0f;
    Leaving leaving = path.leaving;
    for (int surfaces = 0; surfaces < 10000; ++surfaces) {
      Hit hit;
      const float far = left + back;
      const bool met =
          world_.next_surface(origin - back * direction, direction, far * (1 + 1e-5f), inside, leaving, hit);
      const float span = met ? std::clamp(hit.distance - back, 0.0f, left) : left;
      if (met && world_.body(hit.where.object).role != Role::translucent && hit.where.object != target)
        return glm::vec3(0);
      const bool arrived = !met || hit.where.object == target;
      if (arrived && met && span < left * (1 - 1e-3f)) return glm::vec3(0);  // the light's own other parts shade too
      if (!pass(inside, origin, direction, span, result)) return glm::vec3(0);
      if (arrived) return result;
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
  bool pass(const Inside& inside, glm::vec3 origin, glm::vec3 direction, float distance, glm::vec3& result) {
    const FlatMedium* medium = medium_of(inside);
    if (!medium) return true;
    if (!medium->gridded()) {
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

  const World& world_;
  Random& random_;
  PathSample sample_;
  Path mirrored_;
  bool has_mirrored_ = false;
};

}  // namespace

PathSample trace_path(const World& world, glm::vec3 origin, glm::vec3 direction, const Inside& camera_inside,
                      Random& random) {
  return Tracer(world, random).trace(origin, direction, camera_inside);
}

}  // namespace alabaster
