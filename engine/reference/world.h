// The scene as paths see it: what a ray meets next, how far the nearest surface is at the least, and the lights.
#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "reference/distance_grid.h"
#include "reference/guiding.h"
#include "reference/lamps.h"
#include "reference/media.h"
#include "reference/random.h"
#include "scene/rough_lobe.h"
#include "scene/scene.h"

namespace alabaster {

/// The translucent objects a path is in, innermost last. A surface is crossed only where the list allows it (an object
/// is entered from outside and left from inside), so touching, overlapping and doubled faces cannot put a path on the
/// wrong side.
class Inside {
 public:
  bool holds(std::uint32_t object) const {
    for (std::size_t i = 0; i < count_; ++i)
      if (objects_[i] == object) return true;
    return false;
  }
  bool empty() const { return count_ == 0; }
  bool full() const { return count_ == objects_.size(); }
  std::uint32_t top() const { return objects_[count_ - 1]; }
  void push(std::uint32_t object) { objects_[count_++] = object; }
  void remove(std::uint32_t object) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count_; ++i)
      if (objects_[i] != object) objects_[kept++] = objects_[i];
    count_ = kept;
  }

 private:
  std::array<std::uint32_t, 8> objects_{};
  std::size_t count_ = 0;
};

struct Body {
  Role role = Role::opaque;
  FlatMedium medium;
  float eta = 1;
  std::optional<RoughLobe> rough;  // translucent: how its outside mirrors; none: smooth
  glm::vec3 albedo{0};      // opaque
  glm::vec3 radiance{0};    // emissive, W/m^2/sr
  bool two_sided = false;   // emissive
  bool guided = false;      // translucent: paths inside look for the lights through its surface
  float light_density = 0;  // emissive: probability per area that sample_light() picks a point, 1/m^2
  float light_share = 0;    // emissive: probability that sample_light() picks a point of this one
  glm::vec3 centre{0};      // emissive: of its area, m
  float radius = 0;         // emissive: of a disc of its area, m
};

constexpr std::uint32_t nothing = 0xffffffffu;

/// The opaque triangle a ray leaves from.
struct Leaving {
  std::uint32_t object = nothing, triangle = nothing;
};

struct Hit {
  float distance = INFINITY;  // m
  Leaving where;
  glm::vec3 point{0};   // m, on the triangle's plane
  glm::vec3 normal{0};  // unit, the mesh's outside
};

/// What next-event estimation looks at: a point of an emissive mesh, or a lamp.
struct LightPick {
  glm::vec3 point{0}, normal{0};
  std::uint32_t object = nothing;
  std::uint32_t lamp = nothing;
  std::uint32_t sky = nothing;  // or a cell of the environment's picture
};

/// The disc that a light shows, for guides.
struct LightDisc {
  glm::vec3 centre{0};  // m
  float radius = 0;     // m
  float share = 0;      // probability that World::sample_light() picks this light
};

class World {
 public:
  explicit World(const Scene& scene, Guiding guiding = Guiding::automatic);

  /// The first surface that matters within `far` (m): translucent ones that `inside` allows to be crossed, and every
  /// other but the triangle that is left.
  bool next_surface(glm::vec3 origin, glm::vec3 direction, float far, const Inside& inside, Leaving leaving,
                    Hit& hit) const;

  /// A lower bound of the distance (m) from a point inside `object` to any surface; 0 where nothing is known.
  float clearance(std::uint32_t object, glm::vec3 point) const { return distances_[object].clearance(point); }

  glm::vec3 normal(Leaving where) const { return shapes_[where.object].normals[where.triangle]; }
  std::array<glm::vec3, 3> corners(Leaving where) const {
    const Mesh& mesh = shapes_[where.object].mesh;
    const glm::uvec3 t = mesh.triangles[where.triangle];
    return {mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]};
  }

  const Body& body(std::uint32_t object) const { return bodies_[object]; }
  float nudge() const { return nudge_; }  // m: rays that leave a surface start this far before it
  glm::vec3 sky(glm::vec3 direction) const { return environment_.at(direction); }  // W/m^2/sr
  /// Probability per solid angle that sample_light() and then draw_sky() give this direction, 1/sr; 0 where the sky is
  /// so even that paths find it by chance.
  float sky_density(glm::vec3 direction) const {
    return sky_share_ > 0 ? sky_share_ * environment_.picture->density(direction) : 0;
  }
  glm::vec3 draw_sky(Random& random) const;
  float index_in(const Inside& inside) const { return inside.empty() ? 1.0f : bodies_[inside.top()].eta; }
  bool guided(const Inside& inside) const { return !inside.empty() && bodies_[inside.top()].guided; }
  bool has_lights() const { return !light_weights_.empty(); }
  LightPick sample_light(Random& random) const;
  const std::vector<Lamp>& lamps() const { return lamps_; }
  /// Lights are numbered: emissive objects as objects are, then the lamps, then the cells of the sky.
  std::uint32_t lamp_id(std::size_t lamp) const { return static_cast<std::uint32_t>(bodies_.size() + lamp); }
  std::uint32_t sky_id(std::uint32_t cell) const { return lamp_id(lamps_.size()) + cell; }
  std::uint32_t sky_id(glm::vec3 direction) const { return sky_id(sky_cell(direction)); }
  LightDisc disc(std::uint32_t light) const {
    if (light < bodies_.size()) return {bodies_[light].centre, bodies_[light].radius, bodies_[light].light_share};
    if (light >= sky_id(0u)) return sky_[light - sky_id(0u)];
    const Lamp& lamp = lamps_[light - bodies_.size()];
    return {lamp.centre, lamp.radius, lamp.share};
  }
  /// Whether a point cannot be inside `object`: its bounds do not hold it.
  bool surely_outside(std::uint32_t object, glm::vec3 point) const {
    const Bounds& bounds = shapes_[object].bounds;
    return glm::any(glm::lessThan(point, bounds.low - nudge_)) ||
           glm::any(glm::greaterThan(point, bounds.high + nudge_));
  }
  /// The objects that hold `point`.
  Inside inside_at(glm::vec3 point) const;

 private:
  struct Shape {
    Mesh mesh;
    std::vector<glm::vec3> normals;  // of its triangles
    Bounds bounds;
  };
  struct EmbreeRelease {
    void operator()(RTCDeviceTy* device) const { rtcReleaseDevice(device); }
    void operator()(RTCSceneTy* scene) const { rtcReleaseScene(scene); }
  };
  struct Query;
  static void accept_or_reject(const RTCFilterFunctionNArguments* call);
  void add_geometry(std::uint32_t id);
  void add_lights(std::uint32_t id);
  void add_lamps(const Scene& scene);
  void add_sky(const Bounds& bounds);
  void share_out_lights(const Scene& scene);
  std::uint32_t sky_cell(glm::vec3 direction) const;
  struct Shine {
    float mean = 0, square = 0;  // of the radiance over the sphere of directions
  };
  Shine lights_seen_from(glm::vec3 point) const;
  void measure_distances(std::uint32_t id);
  float chance_of_light(glm::vec3 from) const;

  std::unique_ptr<RTCDeviceTy, EmbreeRelease> device_;
  std::unique_ptr<RTCSceneTy, EmbreeRelease> scene_;
  std::vector<Body> bodies_;
  std::vector<Shape> shapes_;
  std::vector<DistanceGrid> distances_;
  Environment environment_;
  std::vector<LightDisc> sky_;  // none where the sky is left to chance
  float sky_share_ = 0;         // probability that sample_light() picks the sky
  float nudge_ = 0;
  std::vector<Leaving> light_triangles_;
  std::vector<Lamp> lamps_;
  std::vector<double> light_weights_;  // cumulative, ends at 1: the triangles, the lamps, the cells of the sky
};

}  // namespace alabaster
