// Where a solver grid lies: cubic cells, cell (i, j, k) spans origin + h * [i, i+1] x [j, j+1] x [k, k+1].
#pragma once

#include <glm/glm.hpp>

namespace alabaster {

struct GridFrame {
  glm::ivec3 cells{0};     // x is a multiple of 4: four x-neighbours share one rgba32f texel
  float h = 0;             // m
  glm::vec3 origin{0};     // m, world; low corner of cell (0, 0, 0)
};

}  // namespace alabaster
