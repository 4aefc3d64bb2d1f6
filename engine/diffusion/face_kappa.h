// kappa between the unknowns of two cells, from the samples of both.
#pragma once

#include "diffusion/medium_layer.h"

namespace alabaster {

/// A cell on one side of a face.
struct FaceSide {
  const glm::vec3* resistivity;  // 1/m, Pattern::count() of them
  std::uint64_t solid;           // a bit a sample
  const Texture* texture;
  double centre;  // of its unknown along the face's axis, in h from the cell's low corner
};

/// kappa, m, across the face between `lower` and `upper`, whose normal is `axis`: in series along it, in parallel
/// across it.
glm::dvec3 face_kappa(const Pattern& pattern, const FaceSide& lower, const FaceSide& upper, int axis);

}  // namespace alabaster
