// A lit object ready to be solved, for the benchmarks of the solver.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "bench.h"
#include "diffusion/diffusion.h"
#include "problems.h"

namespace alabaster {

struct Shape {
  std::string name;
  Mesh mesh;
};

/// "ball", or the name of a mesh in `folder` ("bunny", "armadillo", "elephant", "hand"): 1 m long.
Shape shape_named(const std::string& name, const std::string& folder);

/// What the studies of the solver are told.
struct BodyStudy {
  std::string meshes = "build/meshes", json, device;
  std::vector<std::string> shapes{"ball"};
  std::vector<int> grids{64, 128};
  std::vector<double> contrasts{1, 1e2, 1e4};
  int runs = 3;

  void add_to(CLI::App& command);
};

/// Milliseconds that `work` takes.
double time_of(const std::function<void()>& work);
/// The median of `runs` times; `before` each is not timed.
double median_time(int runs, const std::function<void()>& before, const std::function<void()>& work);

class BenchBody {
 public:
  BenchBody(gpu::Context& context, const Mesh& mesh, int grid, const MediumField& medium, int channels,
            const SolverOptions& options = {});

  /// Sun light from `direction`, 1 W/m^2 across it, on every facet.
  void light(glm::dvec3 direction);
  MediumSamples sampled(const MediumField& medium) { return sample_medium(context_, domain_, medium, channels_); }
  SolverStatus solve() { return diffusion_.solve(light_); }
  void forget() { diffusion_.forget(); }
  /// Cells with a share of the object.
  int inside_cells() const { return static_cast<int>(domain_.summary.cut_cells + domain_.summary.inner_cells); }
  const Domain& domain() const { return domain_; }
  Diffusion& diffusion() { return diffusion_; }

 private:
  gpu::Context& context_;
  int channels_;
  DiffusionPasses solver_passes_;
  FluencePasses passes_;
  Domain domain_;
  std::vector<GpuCutCell> cut_cells_;
  Diffusion diffusion_;
  gpu::Buffer light_;
};

}  // namespace alabaster
