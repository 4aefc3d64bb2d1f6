// What a translucent object is made of, cell by cell.
#pragma once

#include <functional>
#include <vector>

#include "domain/domain.h"
#include "scene/scene.h"
#include "shared/diffusion.h"

namespace alabaster {

/// Reduced coefficients at a point.
struct MediumPoint {
  glm::dvec3 sigma_s_reduced{0};  // 1/m, sigma_s (1 - g)
  glm::dvec3 sigma_a{0};          // 1/m
};
using MediumField = std::function<MediumPoint(glm::dvec3 world)>;

MediumField field_of(const Medium& medium);

/// Samples at the cells' centroids. Packed arrays are the images' texels (shared/diffusion.h), zero outside.
struct MediumSamples {
  int channels = 3;
  std::vector<float> kappa;         // kappa / kappa_scale
  std::vector<float> absorption;    // sigma_a h^2 / kappa_scale
  std::vector<FacetMedium> facets;  // by index of cut cell; entry 0 unused
  glm::dvec3 kappa_scale{1};        // m: the channel's largest kappa
};

/// kappa = 1 / (3 (sigma_s' + sigma_a)), bounded to 100 times the grid's longest side: a medium clearer than that is
/// none that diffuses. One channel takes red.
MediumSamples sample_medium(gpu::Context& context, const Domain& domain, const MediumField& field, int channels);

}  // namespace alabaster
