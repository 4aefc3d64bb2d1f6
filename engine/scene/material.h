// glTF material -> what an Object is made of.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "scene/fields.h"
#include "scene/scene.h"

namespace alabaster {

/// Where a procedural solid lies in the object's frame.
struct Pattern {
  std::optional<glm::dvec3> origin;
  std::optional<double> size;  // of a unit of the pattern
};

struct Material {
  Role role = Role::opaque;
  double eta = 1;
  Medium medium;  // its world_to_box starts from the object's own frame here
  Pattern pattern;
  glm::vec3 albedo{0.8f};
  glm::vec3 radiance{0};
  bool two_sided = false;
  double roughness = 0;  // translucent
  std::string warning;  // empty, or one line
};

/// The grids of a scene, each file read once.
using GridCache = std::map<std::string, std::shared_ptr<const Grid>>;

/// `material` is the glTF JSON object of one material; .vol files lie relative to the scene file.
/// Multiple-scattering colour to albedo: KHR_materials_volume_scatter (draft), after Kulla and Conty 2017.
/// Throws UserError on any value that is missing, of the wrong kind, not finite or out of range.
Material read_material(const Fields& material, GridCache& grids);

/// The object's frame -> units of a procedural solid's pattern. What the scene leaves open goes by the object's bounds:
/// the origin is their low corner, or their middle for rings and bands; a unit is their longest edge, an eighth of it
/// for checkers.
glm::dmat4 place_pattern(const Pattern& pattern, const Bounds& bounds, std::uint32_t kind);

}  // namespace alabaster
