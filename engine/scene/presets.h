// Measured media by name.
#pragma once

#include <optional>
#include <string>

#include "scene/scene.h"

namespace alabaster {

struct Preset {
  Coefficients coefficients;  // sigma_s is the reduced one: use it with g = 0
  double eta;
};

/// The table of Jensen, Marschner, Levoy, Hanrahan 2001, "A Practical Model for Subsurface Light Transport", figure 5,
/// in 1/m. Nothing for an unknown name.
std::optional<Preset> preset(const std::string& name);

/// The names known, "apple, chicken1, ...".
std::string preset_names();

}  // namespace alabaster
