// By how much the fluences of the diffusion equation and of the beams count as the gather's source, and what it sends
// out along each direction.
#pragma once

#include <glm/glm.hpp>
#include <vector>

namespace alabaster {

/// The gather's source is sigma_s' (diffuse phi + beams phi_b).
struct GatherClosure {
  double diffuse = 1, beams = 1;
};

/// So that out of a half space the gather sends the flux of the diffusion equation's boundary condition, both where
/// light comes up from the depth (Milne's problem) and where diffuse light shines on it; and, where nothing is
/// absorbed, the same radiance in every direction under that light, as the furnace asks. Lengths in 1 / sigma_t', q^2 =
/// 3 (1 - a'), s = 2 A q / 3:
///   from the depth  phi = e^(q z) + r e^(-q z), r = (s - 1) / (s + 1);
///   a beam of k = 1 / mu  phi = B e^(-q z) + C e^(-k z), C = a' k / (1 - a' - k^2 / 3), B = -C (1 + 2 A k / 3) / (1 +
///   s).
/// The diffusion equation's phi is not transport's within a mean free path of a surface, and not where light was just
/// scattered: in an infinite medium without absorption phi there is short of 4/5 phi_b, of which some leave by a
/// surface.
class GatherClosures {
 public:
  /// `eta` the relative index.
  explicit GatherClosures(double eta);

  /// `albedo` is a' >= 0.7 (there q < 1 <= k: no pole).
  GatherClosure at(double albedo) const;
  /// By how much what leaves along this outside cosine counts; the mean over the flux is 1. It is what P1 has wrong in
  /// the angle: at eta 1 it sends 12 % too much along the surface and 1 % too little straight out, from 1.3 on less
  /// than 0.1 %. Transport's radiance under a single beam has the same ratio to it within 0.5 %
  /// (tests/unit/gather_closure.cpp).
  double exit(double cosine) const;

  /// Spread light T that leaves by a surface, 9/35 dT/dz = leak T in mean free paths: SP3's second boundary condition
  /// with the moments of Fresnel's reflectance (Klose and Larsen 2006, J. Comput. Phys. 220), 21/40 at eta 1.
  double leak() const { return leak_; }
  /// Of a half space without absorption in diffuse light: what it sends of spread light over what it sends of the same
  /// light where beams bring it. The closure's own `beams` counts light as if it stayed there.
  double kept() const;

  /// (diffuse, beams) for GATHER_CLOSURES albedos, evenly spread in the root of 1 - a' (closure_of,
  /// shaders/shading/gather_ray.glsl).
  std::vector<glm::vec2> table() const;
  /// exit() for GATHER_EXITS cosines, evenly spread in their root (exit_of, there).
  std::vector<float> exits() const;

 private:
  struct Direction {
    double inside, share;  // refracted cosine; outside cosine dcosine F_t
    double exit = 1;
  };
  /// What leaves at an inside cosine, at level 1 and but for exit(): of phi and of phi_b under diffuse light, and of
  /// phi where light comes up from the depth.
  struct Sent {
    double diffused = 0, once = 0, from_depth = 0;
  };
  Sent sent(double albedo, double view) const;
  /// The closure at which the flux is right, by what is sent along each of the directions.
  GatherClosure closed(double albedo, const std::vector<Sent>& sent) const;

  double eta_, A_, leak_;
  std::vector<Direction> directions_;
  GatherClosure white_;  // at a' = 1
  double exit_scale_ = 1;
};

}  // namespace alabaster
