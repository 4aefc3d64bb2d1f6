#include "shading/gather_closure.h"

#include <algorithm>
#include <cmath>

#include "shared/gather.h"

namespace alabaster {

// Midpoint rules over the outside cosine c on the way in and out, from which mu dmu = c dc / eta^2.
GatherClosure gather_closure(double albedo, double eta) {
  constexpr int cosines = 200;
  const double A = boundary_constant(internal_diffuse_reflectance<double>(eta)),
               q = std::sqrt(3 * std::max(1 - albedo, 1e-10));
  const double s = 2 * A * q / 3, r = (s - 1) / (s + 1);
  double wanted = 0, diffused = 0, once = 0;  // of light from outside: by the boundary condition, of phi, of phi_b
  double from_depth = 0;
  for (int o = 0; o < cosines; ++o) {
    const double out = (o + 0.5) / cosines, view = refracted_cosine(out, eta);
    const double seen = albedo * out * fresnel_transmittance(out, eta) / (2 * eta * eta * cosines);
    from_depth += seen * (1 / (1 - q * view) + r / (1 + q * view));
    for (int i = 0; i < cosines; ++i) {
      const double outside = (i + 0.5) / cosines, k = 1 / refracted_cosine(outside, eta);
      const double enters = outside * fresnel_transmittance(outside, eta), C = albedo * k / (1 - albedo - k * k / 3);
      const double B = -C * (1 + 2 * A * k / 3) / (1 + s);
      wanted += enters * (B + C) / (2 * A) / cosines;
      diffused += enters * seen * (B / (1 + q * view) + C / (1 + k * view));
      once += enters * seen * k / (1 + k * view);
    }
  }
  GatherClosure closure;
  closure.diffuse = (1 + r) / (2 * A) / from_depth;
  closure.beams = (wanted - closure.diffuse * diffused) / once;
  return closure;
}

std::vector<glm::vec2> gather_closures(double eta) {
  std::vector<glm::vec2> closures;
  for (int i = 0; i < GATHER_CLOSURES; ++i) {
    const double root = double(i) / (GATHER_CLOSURES - 1);
    const GatherClosure closure = gather_closure(1 - GATHER_MOST_ABSORBED * root * root, eta);
    closures.emplace_back(closure.diffuse, closure.beams);
  }
  return closures;
}

}  // namespace alabaster
