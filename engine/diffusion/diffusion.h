// The fluence inside a translucent object (the report's diffusion equation with its source boundary condition, Eq. 11),
//   -div(kappa grad phi) + sigma_a phi = 0,  phi + 2 A kappa d_n phi = 4 Gamma_s / F_dt on the surface,
// by finite volumes on cut cells. Set-up and solve are apart: when only the light changes, solve() again.
#pragma once

#include <optional>

#include "diffusion/history.h"
#include "diffusion/medium_samples.h"
#include "diffusion/pcg.h"
#include "diffusion/rim.h"

namespace alabaster {

/// The passes around the linear solver, made once a context.
struct FluencePasses {
  explicit FluencePasses(gpu::Context& context);
  gpu::Pass points, conductances, assemble, scale;
  gpu::Pass facets[2], rim, power, source[2][2];  // [corrected][in cells]
  gpu::Pass rescale, absorbed, energy, gradient, carry, inner[2], surface[2],
      exit[2];  // [three channels], exit [straight]
};

/// Where a channel's light went, W: in = integral Gamma_s; absorbed = integral sigma_a phi; out = what the render query
/// sends out of the surface, all directions. At convergence in = absorbed + out.
struct EnergyBalance {
  glm::dvec3 in{0}, absorbed{0}, out{0};
  double imbalance() const;  // largest |in - absorbed - out| / in over the channels with light
};

/// What drives the fluence. On the facets, W/m^2: `sides` vec3 (one channel takes red) for every cut cell of the
/// domain, entry 0 included; 2 where the sides of the surface (GpuCutCell::side) have their own.
struct FacetLight {
  FacetLight(const gpu::Buffer& buffer, int entries = 1)
      : gamma_s(buffer), sides(entries), query(&buffer), entered(&buffer) {}
  const gpu::Buffer& gamma_s;  // of the boundary condition: phi + 2 A kappa d_n phi = 4 gamma_s / F_dt
  int sides;
  const gpu::Buffer* query;    // the Gamma_s that the render query subtracts
  const gpu::Buffer* entered;  // as large as all that enters: sets the unit of fluence
  // Source in the cells, W, packed like kappa (shared/diffusion.h), and its sum; none without.
  const gpu::Image* volume = nullptr;
  glm::dvec3 volume_power{0};
  const gpu::Buffer* through = nullptr;  // two vec3 a cut cell: what leaves there without having been scattered
};

/// An image for `layers` quantities of `count` cut cells (shared/diffusion.h).
gpu::Image cut_table(gpu::Context& context, std::size_t count, int layers, const std::string& name);

class Diffusion {
 public:
  /// `domain` and the passes outlive this. One or three channels, as `medium` has.
  Diffusion(gpu::Context& context, const DiffusionPasses& solver_passes, const FluencePasses& passes,
            const Domain& domain, MediumSamples medium, double eta, const SolverOptions& options = {});

  /// A new medium on the same grid; the solution stays as the start of the next solve.
  void set_medium(MediumSamples medium);

  /// Forgets what was solved before: the next solve starts from zero.
  void forget();

  /// Starts from the solution of before where there is one. Then makes surface() and surface_gamma(). Where it is the
  /// `last`, frees the multigrid, most of the memory, in between; nothing can be solved again.
  SolverStatus solve(const FacetLight& light, bool last = false);

  /// One step of solve(), to the relative residual `tolerance`, for light that is not final yet: makes neither
  /// surface() nor surface_gamma().
  SolverStatus approach(const FacetLight& light, double tolerance);

  /// Radiance over F_t that leaves each side of each cut cell, W/m^2/sr: the query's bracket times exit_scale / (4 pi)
  /// and what goes straight through, into the vec3 `radiance[first + 2 * cut cell + side]`. exit_scale is 1 / eta^2. Of
  /// the last solve or approach, for light with two sides.
  void record_exit(gpu::Commands& commands, const FacetLight& light, double exit_scale, const gpu::Buffer& radiance,
                   std::uint32_t first);

  /// Of the last solve.
  EnergyBalance energy(const FacetLight& light);

  /// Fluence for the surface query, W/m^2, rgba32f, one texel a cell with its value at the cell's centre: sampled
  /// trilinearly at a point of the surface it gives phi there. One channel fills r, g and b.
  /// There are two, for the two sides of a thin part: 0 for normals that point mainly up an axis, 1 for down.
  const gpu::Image& surface(int side = 0) const { return surface_[side]; }
  /// Gamma_s of the facets for the surface query (FacetLight::query), W/m^2, in the same form.
  const gpu::Image& surface_gamma(int side = 0) const { return surface_gamma_[side]; }
  /// FacetMedium for every cut cell.
  const gpu::Buffer& facet_medium() const { return facets_; }
  Multigrid& multigrid() { return multigrid_; }
  Pcg& pcg() { return pcg_; }
  int channels() const { return multigrid_.channels(); }
  double A() const { return A_; }
  /// The medium cell by cell, packed: kappa / kappa_scale() and sigma_a h^2 / kappa_scale().
  const gpu::Image& kappa() const { return kappa_; }
  const gpu::Image& absorption() const { return absorption_; }
  glm::dvec3 kappa_scale() const { return kappa_scale_; }
  /// FluenceScale of each channel: fluence = unit * (pcg().solution() + pcg().solution_rest()).
  const gpu::Buffer& scales() const { return scales_; }
  /// Table of the cut cells, a layer a channel: conductances.comp.
  const gpu::Image& facet_conductances() const { return conductances_; }
  const Rim& rim() const { return rim_; }

 private:
  SurfacePush surface_push(int sides = 1) const;
  bool adopt_light(const FacetLight& light);
  void record_rescale(gpu::Commands& commands);
  void record_source(gpu::Commands& commands, const FacetLight& light, bool corrected);
  void record_gradients(gpu::Commands& commands, const FacetLight& light);
  void record_surface(gpu::Commands& commands, const FacetLight& light);

  gpu::Context& context_;
  const FluencePasses& passes_;
  const Domain& domain_;
  double A_, f_dt_;
  int cut_count_;  // entry 0 included
  gpu::Image kappa_, absorption_, surface_[2], surface_gamma_[2];
  gpu::Buffer near_cells_, cut_neighbours_;                                           // for the surface
  gpu::Image points_, lines_, side_lights_, gradients_, conductances_, face_fluxes_;  // tables
  Rim rim_;
  bool power_in_cells_ = false;  // in the right-hand side
  gpu::Buffer facets_, scales_, energy_sums_;
  gpu::Buffer cell_sources_, facet_offsets_;
  SolverOptions options_;
  glm::dvec3 kappa_scale_{1};
  Multigrid multigrid_;
  Pcg pcg_;
  std::optional<SolutionHistory> history_;
};

}  // namespace alabaster
