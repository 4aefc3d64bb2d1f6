// The environment's picture as a few distant lights.
#pragma once

#include <vector>

#include "scene/environment.h"

namespace alabaster {

struct SkyPart {
  glm::vec3 direction{0};  // unit, to the middle of its light
  glm::vec3 flux{0};       // W/m^2: integral of radiance times the cosine from `direction`
  float spread = 0;        // half its width, as a cosine at right angles to its direction
};

/// Cuts the picture into at most `count` rectangles, always the one with the most light times width next, where it has
/// half its light on either side (after P. Debevec, "A Median Cut Algorithm for Light Probe Sampling", 2005). Each
/// stands for its light exactly on every surface that faces all of it: a cosine is linear in the direction. Black parts
/// are left out.
std::vector<SkyPart> cut_sky(const EnvironmentPicture& picture, int count);

}  // namespace alabaster
