// Shapes of 1 m and media that try the solver: what its iterations and times are told of.
#pragma once

#include <cmath>
#include <string>

#include "diffusion/medium_samples.h"
#include "scene/off.h"
#include "scene/shapes.h"

namespace alabaster {

/// A medium without absorption whose kappa (m) is given.
inline MediumPoint scatterer(glm::dvec3 kappa) { return {1.0 / (3.0 * kappa), glm::dvec3(0)}; }

constexpr double study_kappa = 0.02;  // m, the larger one

/// kappa that jumps by `contrast` between blocks of `edge` metres.
inline MediumField checker_medium(double edge, double contrast) {
  return [=](glm::dvec3 p) {
    const glm::ivec3 b(glm::floor(p / edge));
    return scatterer(glm::dvec3((b.x + b.y + b.z) & 1 ? study_kappa / contrast : study_kappa));
  };
}

/// Veins of high kappa in a medium of low: bent sheets, broken into pieces, `width` of their distance thick.
inline MediumField vein_medium(double width, double contrast) {
  return [=](glm::dvec3 p) {
    const double bend = std::sin(9 * p.x + 4 * p.y) + std::sin(11 * p.y - 5 * p.z) + std::sin(8 * p.z + 6 * p.x);
    const double fine = std::sin(23 * p.x - 9 * p.z) * std::sin(19 * p.y + 7 * p.x) * std::sin(21 * p.z + 5 * p.y);
    const double broad = std::sin(8 * glm::dot(p, glm::dvec3(0.62, 0.7, 0.35)) + 1.6 * bend + 2 * fine);
    const double thin = std::sin(11 * glm::dot(p, glm::dvec3(-0.5, 0.75, 0.45)) - 1.9 * bend + 3 * fine);
    const bool in_vein = std::abs(broad) < width || std::abs(thin) < 0.6 * width;
    return scatterer(glm::dvec3(in_vein ? study_kappa : study_kappa / contrast));
  };
}

/// Layers of `thickness` metres, askew in the grid.
inline MediumField layer_medium(double thickness, double contrast) {
  return [=](glm::dvec3 p) {
    const double d = glm::dot(p, glm::normalize(glm::dvec3(0.4, 0.7, 1))) / thickness;
    return scatterer(glm::dvec3(static_cast<int>(std::floor(d)) & 1 ? study_kappa : study_kappa / contrast));
  };
}

/// kappa whose logarithm wanders smoothly.
inline MediumField smooth_medium(double contrast) {
  return [=](glm::dvec3 p) {
    const double s = std::sin(19 * p.x + 3 * p.y + 1) * std::sin(23 * p.y - 4 * p.z) * std::sin(17 * p.z + 5 * p.x + 2);
    return scatterer(glm::dvec3(study_kappa * std::pow(contrast, 0.5 * (s - 1))));
  };
}

/// `mesh` moved to the origin, its longest side 1 m.
inline Mesh of_unit_size(const Mesh& mesh) {
  const Bounds b = bounds_of(mesh);
  const double longest = std::max({b.size().x, b.size().y, b.size().z});
  return transformed(mesh, scaling(glm::dvec3(1 / longest)) * translation(-0.5 * glm::dvec3(b.low + b.high)));
}

}  // namespace alabaster
