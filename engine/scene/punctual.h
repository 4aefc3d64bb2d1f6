// KHR_lights_punctual: lights without a mesh.
#pragma once

#include <vector>

#include "scene/fields.h"
#include "scene/scene.h"

namespace alabaster {

/// One light of the extension's list, at a node with the given transform. Candela and lux are read as W/sr and W/m^2;
/// `range`, a hint to game engines, is not used (Scene::warnings says so). Besides the standard's fields it reads
/// extras.radius (m, of a point or spot light) and extras.angular_radius (radians, of a directional one); without them
/// `radius` is negative and give_extent() chooses. Throws UserError for values out of range.
PunctualLight read_punctual(const Fields& light, const glm::dmat4& to_world, std::vector<std::string>& warnings);

/// Gives every light without a radius the usual one: 0.02 of its distance from the middle of the translucent objects,
/// but not more than a quarter of the way to the nearest surface; a directional one 0.02 radians. Throws UserError for
/// a light inside a translucent object or nearer to a surface than its own radius.
void give_extent(Scene& scene);

}  // namespace alabaster
