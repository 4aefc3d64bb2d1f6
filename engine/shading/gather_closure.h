// By how much the fluences of the diffusion equation and of the beams count as the gather's source.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace alabaster {

/// The gather's source is sigma_s' (diffuse phi + beams phi_b).
struct GatherClosure {
  double diffuse = 1, beams = 1;
};

/// So that out of a half space the gather sends the flux of the diffusion equation's boundary condition, both where
/// light comes up from the depth (Milne's problem) and where diffuse light shines on it. Lengths in 1 / sigma_t', q^2 =
/// 3 (1 - a'), s = 2 A q / 3:
///   from the depth  phi = e^(q z) + r e^(-q z), r = (s - 1) / (s + 1);
///   a beam of k = 1 / mu  phi = B e^(-q z) + C e^(-k z), C = a' k / (1 - a' - k^2 / 3), B = -C (1 + 2 A k / 3) / (1 +
///   s).
/// The diffusion equation's phi is not transport's within a mean free path of a surface, and not where light was just
/// scattered: in an infinite medium without absorption phi there is short of 4/5 phi_b, of which some leave by a
/// surface. `albedo` is a' >= 0.7 (there q < 1 <= k: no pole), `eta` the relative index.
GatherClosure gather_closure(double albedo, double eta);

/// (diffuse, beams) for GATHER_CLOSURES albedos, evenly spread in the root of 1 - a' (closure_of,
/// shaders/shading/gather_ray.glsl).
std::vector<glm::vec2> gather_closures(double eta);

}  // namespace alabaster
