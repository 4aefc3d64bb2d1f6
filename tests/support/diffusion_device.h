// An object with a medium, ready to be solved on the device.
#pragma once

#include <algorithm>
#include <memory>

#include "diffusion/diffusion.h"
#include "scene/shapes.h"
#include "shared/optics.h"
#include "support/device.h"

namespace alabaster {

inline MediumField uniform_medium(double kappa, double sigma_a) {
  const MediumPoint point{glm::dvec3(1 / (3 * kappa) - sigma_a), glm::dvec3(sigma_a)};
  return [point](glm::dvec3) { return point; };
}

/// Value of packed channel `channel` at a cell, W/m^2, to the digits of both parts.
struct FluenceField {
  std::vector<double> phi;  // x fastest, [channel][z][y][x]
  glm::ivec3 n;
  double at(glm::ivec3 c, int channel = 0) const {
    return phi[c.x + std::size_t(n.x) * (c.y + std::size_t(n.y) * (c.z + channel * n.z))];
  }
};

struct Solved {
  SolverStatus status;
  EnergyBalance energy;
};

class Body {
 public:
  Body(gpu::Context& context, const Mesh& mesh, int cells, const MediumField& field, int channels = 1, double eta = 1.3,
       const SolverOptions& options = {})
      : context_(context),
        solver_passes_(context),
        passes_(context),
        domain_(make_domain(context, mesh, choose_frame(bounds_of(mesh), cells))),
        cut_cells_(gpu::download<GpuCutCell>(context, domain_.cut_cells)),
        f_dt_(1 - internal_diffuse_reflectance(eta)),
        diffusion_(context, solver_passes_, passes_, domain_, sample_medium(context, domain_, field, channels), eta,
                   options) {}

  Solved solve(const std::vector<glm::vec3>& gamma_s) {
    const gpu::Buffer buffer = gpu::make_buffer(context_, gamma_s, "gamma_s");
    Solved solved;
    solved.status = diffusion_.solve(buffer);
    solved.energy = diffusion_.energy(buffer);
    return solved;
  }
  Solved solve(glm::vec3 gamma_s) { return solve(std::vector<glm::vec3>(cut_cells_.size(), gamma_s)); }

  FluenceField fluence() {
    const std::vector<float> high = gpu::download<float>(context_, diffusion_.pcg().solution());
    const std::vector<float> low = gpu::download<float>(context_, diffusion_.pcg().solution_rest());
    const std::vector<FluenceScale> scales = gpu::download<FluenceScale>(context_, diffusion_.scales());
    FluenceField field{{}, domain_.frame.cells};
    const std::size_t cells = high.size() / diffusion_.multigrid().channels();
    for (std::size_t i = 0; i < high.size(); ++i)
      field.phi.push_back((double(high[i]) + low[i]) * scales[i / cells].unit);
    return field;
  }

  /// Trilinear, as the raster pass samples it.
  double surface_at(glm::dvec3 world, int channel = 0) {
    if (surface_.empty()) surface_ = gpu::download<float>(context_, diffusion_.surface());
    const GridFrame& frame = domain_.frame;
    const glm::dvec3 p = (world - glm::dvec3(frame.origin)) / double(frame.h) - 0.5;
    const glm::ivec3 low = glm::ivec3(glm::floor(p));
    const glm::dvec3 f = p - glm::dvec3(low);
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 up{corner & 1, corner >> 1 & 1, corner >> 2}, c = low + up;
      double w = 1;
      for (int a = 0; a < 3; ++a) w *= up[a] ? f[a] : 1 - f[a];
      sum += w * surface_[4 * (c.x + std::size_t(frame.cells.x) * (c.y + std::size_t(frame.cells.y) * c.z)) + channel];
    }
    return sum;
  }

  glm::dvec3 facet_centre(std::size_t i) const {
    return glm::dvec3(domain_.frame.origin) +
           double(domain_.frame.h) * (glm::dvec3(cut_cells_[i].cell) + glm::dvec3(cut_cells_[i].facet.centre));
  }
  const Domain& domain() const { return domain_; }
  const std::vector<GpuCutCell>& cut_cells() const { return cut_cells_; }
  double f_dt() const { return f_dt_; }
  Diffusion& diffusion() { return diffusion_; }

 private:
  gpu::Context& context_;
  DiffusionPasses solver_passes_;
  FluencePasses passes_;
  Domain domain_;
  std::vector<GpuCutCell> cut_cells_;
  double f_dt_;
  Diffusion diffusion_;
  std::vector<float> surface_;
};

/// Relative error of the surface fluence over the mesh's vertices (which lie on the true surface).
struct SurfaceError {
  double l2 = 0, bias = 0, worst = 0;
};
template <class Exact>
SurfaceError surface_error(Body& body, const Mesh& mesh, Exact exact, int channel = 0) {
  SurfaceError error;
  double square = 0, norm = 0, sum = 0, all = 0;
  for (const glm::vec3& p : mesh.positions) {
    const double e = exact(glm::dvec3(p)), d = body.surface_at(p, channel) - e;
    square += d * d, norm += e * e, sum += d, all += e;
    error.worst = std::max(error.worst, std::abs(d / e));
  }
  error.l2 = std::sqrt(square / norm);
  error.bias = sum / all;
  return error;
}

}  // namespace alabaster
