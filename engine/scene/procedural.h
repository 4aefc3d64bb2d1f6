// Procedural solids in scenes: their names, usual parts and parameters. The patterns are in shared/procedural.h.
#pragma once

#include <string>

#include "scene/fields.h"
#include "scene/scene.h"
#include "shared/procedural.h"

namespace alabaster {

/// The kinds by the names that scenes use, in the order of shared/procedural.h.
extern const char* const solid_names[solid_kinds];

/// How many parts a kind has: 3 for skin, 2 for the others.
int parts_of(std::uint32_t kind);

/// Width of a solid's finest lines in units of its pattern, about; not for skin.
double solid_feature(const ProceduralSolid& solid);

/// A kind with its usual parts and parameters.
ProceduralSolid usual_solid(std::uint32_t kind);

/// Reads "name", "seed", "turbulence", "sharpness", "depths" (m) and "parts" ({"sigma_s": .., "sigma_a": ..} in 1/m or
/// {"preset": name}) of an extras.medium of type "procedural"; what is not given is usual. Throws UserError for values
/// that are unknown or out of range.
ProceduralSolid read_procedural(const Fields& medium);

/// At a point in units of the pattern, `depth` m below the surface; real is float or double.
template <typename real>
struct SolidCoefficients {
  glm::vec<3, real> sigma_s, sigma_a;  // 1/m
};
template <typename real>
SolidCoefficients<real> solid_at(const ProceduralSolid& solid, glm::vec<3, real> p, real depth) {
  real share[3];
  for (unsigned part : {1u, 2u})
    share[part] = solid_share<real>(solid.kind, solid.seed, solid.turbulence, solid.sharpness, solid.depths.x,
                                    solid.depths.y, part, p.x, p.y, p.z, depth);
  share[0] = 1 - share[1] - share[2];
  SolidCoefficients<real> sum{glm::vec<3, real>(0), glm::vec<3, real>(0)};
  for (int part = 0; part < 3; ++part) {
    sum.sigma_s += share[part] * glm::vec<3, real>(solid.parts[part].sigma_s);
    sum.sigma_a += share[part] * glm::vec<3, real>(solid.parts[part].sigma_a);
  }
  return sum;
}

}  // namespace alabaster
