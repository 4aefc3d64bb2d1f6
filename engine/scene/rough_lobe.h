// The directional albedo of a rough dielectric's mirrored light (shared/rough.h), tabulated.
#pragma once

#include <array>

#include "shared/rough.h"

namespace alabaster {

struct RoughLobe {
  double eta = 1;                             // index inside / outside
  float alpha = 0;                            // roughness^2
  std::array<float, rough_entries> albedo{};  // E at mu = (k / (rough_entries - 1))^2
  float mean_deficit = 0;                     // d_mean

  float albedo_at(float mu) const;
  RoughView view(float mu) const;
  /// f(o, i) n.i and the density with which mirrored() picks i, 1/sr; unit directions, z along the normal.
  glm::vec2 value_and_density(glm::vec3 o, glm::vec3 i) const;
  /// A mirrored direction for three numbers uniform in [0, 1); below the surface (z <= 0) nothing is mirrored.
  glm::vec3 mirrored(glm::vec3 o, glm::vec3 uvw) const;
};

/// By quadrature over visible normals; E is right to about 1e-4 of F. `roughness` in (0, 1].
RoughLobe make_rough_lobe(double roughness, double eta);

}  // namespace alabaster
