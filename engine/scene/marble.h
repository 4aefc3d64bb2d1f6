#pragma once

#include "scene/scene.h"

namespace alabaster {

/// Marble with darker veins over the box `bounds`, cells^3 grid cells: Jensen et al. 2001's marble between the veins,
/// in them 60 times the absorption and less scattering. Made of value noise with a seed of its own: the same everywhere
/// to rounding.
Medium veined_marble(const Bounds& bounds, int cells);

}  // namespace alabaster
