// What a translucent object is made of, averaged over the solver's cells.
#pragma once

#include <cmath>
#include <functional>
#include <string>
#include <type_traits>
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

/// Reduced coefficients anywhere in the world.
struct MediumField {
  MediumField() = default;
  template <class F, class = std::enable_if_t<std::is_invocable_r_v<MediumPoint, F, glm::dvec3>>>
  MediumField(F function, double feature_size = INFINITY) : at(std::move(function)), feature(feature_size) {}
  MediumPoint operator()(glm::dvec3 world) const { return at(world); }

  std::function<MediumPoint(glm::dvec3 world)> at;
  double feature = INFINITY;  // m: width of the finest thing in it; infinite where nothing is finer than a cell
};

/// Its feature is Medium::feature_size().
MediumField field_of(const Medium& medium);

/// Cells are sub-sampled so that a feature is met twice along each axis, but at most this often: features down to a
/// quarter of a cell keep what they absorb and how they conduct. Once, at the centroid, where they are two cells wide
/// or more.
inline constexpr int most_samples_an_axis = 4;
int samples_an_axis(double feature, double h);

/// Averages that keep what the medium does, each over the solid part of a cell only. Packed arrays are the images'
/// texels (shared/diffusion.h), zero outside.
struct MediumSamples {
  int channels = 3;
  /// kappa / kappa_scale between the unknowns on the two sides of a cell's low x, y and z face: in series along the
  /// axis, in parallel across it. DIFFUSION_FINEST_ENTRIES a cell, the last unused.
  std::vector<float> kappa;
  std::vector<float> absorption;      // sigma_a h^2 / kappa_scale, mean over the volume
  std::vector<float> cell_kappa;      // kappa / kappa_scale of the mean extinction: what a beam meets in the cell
  std::vector<FacetMedium> facets;    // by index of cut cell, of the layer between surface and unknown; entry 0 unused
  glm::dvec3 kappa_scale{1};          // m: the channel's largest kappa
  std::vector<std::string> warnings;  // one line each, with the remedy
};

/// kappa = 1 / (3 (sigma_s' + sigma_a)), bounded to 100 times the grid's longest side: a medium clearer than that is
/// none that diffuses. One channel takes red.
MediumSamples sample_medium(gpu::Context& context, const Domain& domain, const MediumField& field, int channels);

}  // namespace alabaster
