// Where light that a surface bends comes from: directions from a point inside an object towards a lamp outside.
#pragma once

#include <glm/glm.hpp>

#include "reference/random.h"
#include "reference/world.h"

namespace alabaster {

/// A density of directions around the one in which a lamp is likely to be seen from a point behind refracting surfaces.
/// The direction comes from a few fixed-point steps of Snell's law on the mesh and need not be right: whatever it is,
/// the density is positive everywhere, known exactly, and a function of the arguments alone, so directions drawn from
/// it can be weighed against those drawn from a phase function (E. Veach, L. Guibas, "Optimally Combining Sampling
/// Techniques for Monte Carlo Rendering", 1995).
class LightGuide {
 public:
  LightGuide(const World& world, glm::vec3 point, const Inside& inside, std::uint32_t emitter);
  /// False where the lamp fills so much of the sky that chance finds it; then the density is 0.
  bool useful() const { return useful_; }
  /// Times the probability that sample_light() picks this emitter, 1/sr.
  float density(glm::vec3 direction) const;
  glm::vec3 sample(Random& random) const;

 private:
  bool useful_ = false;
  glm::vec3 axis_{0};
  float picked_ = 0;  // probability of the emitter
  float narrow_ = 0;  // mean cosine of the lobe that is as wide as the lamp
};

}  // namespace alabaster
