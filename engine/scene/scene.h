// What the rest of the house knows of a scene: closed triangle meshes in world space (metres), what they are made of,
// what lights them and who looks at them. Made by load_scene() from glTF 2.0 (load.h); nothing here knows a file
// format.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "scene/environment.h"

namespace alabaster {

/// Triangles in world space, counter-clockwise seen from outside.
struct Mesh {
  std::vector<glm::vec3> positions;   // m
  std::vector<glm::uvec3> triangles;  // indices into positions
};

struct Bounds {
  glm::vec3 low{INFINITY}, high{-INFINITY};  // m
  void add(glm::vec3 p) { low = glm::min(low, p), high = glm::max(high, p); }
  glm::vec3 size() const { return high - low; }
  glm::vec3 centre() const { return 0.5f * (low + high); }
};
Bounds bounds_of(const Mesh& mesh);

/// A regular grid of values at cell centres (Mitsuba .vol layout: x fastest, then y, then z; channels innermost).
/// Outside the box the nearest cell's value holds ("wrap clamp").
struct Grid {
  glm::ivec3 size{0};         // cells
  int channels = 1;           // 1 or 3
  std::vector<float> values;  // size.x * size.y * size.z * channels
  bool trilinear = true;      // else the nearest cell

  glm::dvec3 at(glm::ivec3 cell) const;           // clamped to the grid; grey is spread over r, g, b
  glm::dvec3 sample(glm::dvec3 unit_cube) const;  // position in the box, each coordinate 0..1
  glm::dvec3 largest() const;                     // value of each channel
};

struct ProceduralSolid;  // shared/procedural.h

/// Scattering and absorption at a point.
struct Coefficients {
  glm::dvec3 sigma_s{0};  // 1/m
  glm::dvec3 sigma_a{0};  // 1/m
};

/// What a translucent object is made of: by grids, a procedural solid, or the same everywhere.
/// Grids: sigma_s = scale * sigma_t * albedo, sigma_a = scale * sigma_t * (1 - albedo), or scale times those of sigma_s
/// and sigma_a themselves; each grid is interpolated by itself.
struct Medium {
  Coefficients homogeneous;
  double g = 0;  // mean cosine of the Henyey-Greenstein phase function, in (-1, 1)

  std::shared_ptr<const Grid> sigma_t;  // 1/m before `scale`; null in other media
  std::shared_ptr<const Grid> albedo;   // 0..1
  std::shared_ptr<const Grid> sigma_s;  // 1/m before `scale`; with sigma_a, instead of the two above
  std::shared_ptr<const Grid> sigma_a;  // 1/m before `scale`
  double scale = 1;                     // factor of sigma_t, or of sigma_s and sigma_a
  glm::dmat4 world_to_box{1.0};         // world position -> unit cube of the grids, or units of the solid's pattern

  std::shared_ptr<const ProceduralSolid> solid;  // null in other media
  std::shared_ptr<const Grid> depth;             // m below the surface; only where the solid is one of layers
  glm::dmat4 world_to_depth{1.0};                // world position -> unit cube of `depth`

  bool gridded() const { return sigma_t || sigma_s; }
  bool heterogeneous() const { return gridded() || solid; }
  /// Whether no channel differs from another anywhere.
  bool grey() const;
  Coefficients at(glm::dvec3 world) const;
  /// Largest sigma_t = sigma_s + sigma_a per channel over the whole medium, 1/m (for grids of sigma_s and sigma_a, the
  /// sum of their largest).
  glm::dvec3 majorant() const;
  /// m: width of the finest thing in it. Of grids the shortest edge of a voxel, twice that where interpolated; of
  /// solids that of their finest lines; INFINITY where it is the same everywhere.
  double feature_size() const;
};

enum class Role { translucent, opaque, emissive };

struct Object {
  std::string name;
  Role role = Role::opaque;
  Mesh mesh;
  Medium medium;           // translucent
  double eta = 1;          // translucent: index inside / index outside
  glm::vec3 albedo{0.8f};  // opaque: Lambert reflectance
  glm::vec3 radiance{0};   // emissive: W/m^2/sr, from the front side
  bool two_sided = false;  // emissive: from both sides
  double roughness = 0;    // translucent: of its surface, 0 (smooth) to 1; GGX with alpha = roughness^2
};

struct Camera {
  std::string name;
  glm::mat4 to_world{1};  // looks along -z, y up (glTF)
  float y_fov = 0.7f;     // radians
};

/// A light without a mesh (KHR_lights_punctual). It is nowhere seen itself, nor in mirroring surfaces; it lights what
/// scatters. It has a small extent, so that paths find it behind a surface that bends light, where a point or a single
/// direction is met with probability 0. A far surface that faces all of it gets exactly what the ideal light would
/// send.
struct PunctualLight {
  enum class Kind { point, spot, directional };
  std::string name;
  Kind kind = Kind::point;
  glm::vec3 intensity{0};                  // point, spot: W/sr, a spot's on its axis; directional: W/m^2 across its way
  glm::vec3 position{0};                   // m; point, spot
  glm::vec3 direction{0, 0, -1};           // unit, where a spot or directional light shines
  double inner_cone = 0;                   // spot: radians off its axis up to which it is undiminished
  double outer_cone = 0.7853981633974483;  // spot: and from which on it is dark
  // Point, spot: m, of the sphere whose every point shines alike; directional: radians, half the angle of the disc in
  // the sky. 0 is an ideal light, which the path tracer refuses where a surface bends its light.
  double radius = 0;
};

struct Scene {
  std::string path;
  std::vector<Object> objects;
  std::vector<PunctualLight> lights;
  std::vector<Camera> cameras;
  Environment environment;  // dark where the scene has none
  std::vector<std::string>
      warnings;  // one line each, with the object's name: repairs that were made, doubts that remain
};

}  // namespace alabaster
