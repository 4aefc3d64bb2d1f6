// How a path is followed; only paths.cpp and path_lights.cpp see this.
#pragma once

#include <algorithm>
#include <glm/glm.hpp>

#include "reference/path.h"

namespace alabaster {

inline float largest(glm::vec3 v) { return std::max(v.x, std::max(v.y, v.z)); }

/// The directions in which a vertex sends light on: a phase function about the direction it came along, or a Lambert
/// surface about its normal.
struct Lobe {
  glm::vec3 axis{0};
  float g = 0;
  bool lambert = false;
  /// Also the value, for light from there: both lobes are drawn from exactly; 1/sr.
  float density(glm::vec3 direction) const {
    const float cosine = glm::dot(axis, direction);
    return lambert ? std::max(0.0f, cosine) / pi : phase_value(g, cosine);
  }
};

class Tracer {
 public:
  Tracer(const World& world, Random& random) : world_(world), random_(random) {}

  PathSample trace(glm::vec3 origin, glm::vec3 direction, const Inside& inside);

 private:
  enum class Event { collision, surface, escape };

  void follow(Path& path);

  const FlatMedium* medium_of(const Inside& inside) const {
    if (inside.empty()) return nullptr;
    const FlatMedium& medium = world_.body(inside.top()).medium;
    return medium.empty() ? nullptr : &medium;
  }

  void collect(const Path& path, glm::vec3 radiance) {
    const float n = world_.index_in(path.inside);
    sample_.radiance[static_cast<std::size_t>(path.layer())] += path.weight() * radiance / (n * n);
  }

  bool roulette(Path& path);

  // Next surface within `far` of the path's origin; its distance is measured from there.
  bool cast(const Path& path, float far, Hit& hit) const {
    const float back = path.on_surface ? world_.nudge() : 0.0f;
    if (!world_.next_surface(path.origin - back * path.direction, path.direction, far + back, path.inside, path.leaving,
                             hit))
      return false;
    hit.distance = std::max(0.0f, hit.distance - back);
    return true;
  }

  // Flights.
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

  Event advance(Path& path, Hit& hit);
  Event advance_in_homogeneous(Path& path, const FlatMedium& medium, Hit& hit);
  Event advance_in_grid(Path& path, const FlatMedium& medium, Hit& hit);

  // What happens at their ends; false where the path ends there, too.
  bool scatter(Path& path);
  bool meet(Path& path, const Hit& hit);
  bool cross(Path& path, const Hit& hit, bool first);
  bool mirror(Path& path, const Body& body, bool entering, glm::vec3 n, float cosine);
  bool reflect_diffusely(Path& path, const Hit& hit, const Body& body);

  // Lights (path_lights.cpp).
  void shine(Path& path, const Hit& hit, const Body& body);
  void shine_from_sky(const Path& path);
  void meet_lamps(const Path& path, float limit);
  void see_lights(Path& path, const Lobe& lobe);
  void see_straight(Path& path, const LightPick& light, float asked, const Lobe& lobe);
  void see_sky(Path& path, float asked, const Lobe& lobe);
  void see_lamp(const Path& path, const Lamp& lamp, float asked, const Lobe& lobe);
  void see_guided(const Path& path, std::uint32_t light, float asked, const Lobe& lobe);
  void shoot(Path& ray, std::uint32_t light);
  glm::vec3 transmittance(const Path& path, glm::vec3 direction, float distance, std::uint32_t target);
  bool pass(const Inside& inside, glm::vec3 origin, glm::vec3 direction, float distance, glm::vec3& result);

  // Surfaces of another index bend light: nothing is seen straight through them.
  bool behind_glass(const Inside& inside) const { return world_.index_in(inside) != 1; }

  const World& world_;
  Random& random_;
  PathSample sample_;
  Path mirrored_;
  bool has_mirrored_ = false;
};

}  // namespace alabaster
