#include "body.h"

#include <numbers>

#include "scene/error.h"

namespace alabaster {

Shape shape_named(const std::string& name, const std::string& folder) {
  if (name == "ball") return {name, icosphere(5, 0.5f)};
  const std::string file = name == "bunny" ? "bunny00" : name == "elephant" ? "refined_elephant" : name;
  return {name, of_unit_size(read_off(folder + "/" + file + ".off"))};
}

void BodyStudy::add_to(CLI::App& command) {
  command.add_option("--meshes", meshes, "folder of the scanned meshes")->capture_default_str();
  command.add_option("--shapes", shapes, "ball, bunny, armadillo, ...")->delimiter(',')->capture_default_str();
  command.add_option("--grids", grids, "cells along the longest side")->delimiter(',')->capture_default_str();
  command.add_option("--contrasts", contrasts, "ratios of kappa")->delimiter(',')->capture_default_str();
  command.add_option("--runs", runs, "counted runs")->check(CLI::Range(1, 1000))->capture_default_str();
  command.add_option("--device", device, "part of the Vulkan device's name");
  command.add_option("--json", json, "results (JSON)");
}

double time_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

double median_time(int runs, const std::function<void()>& before, const std::function<void()>& work) {
  std::vector<double> times;
  for (int i = 0; i < runs; ++i) {
    before();
    times.push_back(time_of(work));
  }
  return median(times);
}

BenchBody::BenchBody(gpu::Context& context, const Mesh& mesh, int grid, const MediumField& medium, int channels,
                     const SolverOptions& options)
    : context_(context),
      channels_(channels),
      solver_passes_(context),
      passes_(context),
      domain_(make_domain(context, mesh, choose_frame(bounds_of(mesh), grid))),
      cut_cells_(gpu::download<GpuCutCell>(context, domain_.cut_cells)),
      diffusion_(context, solver_passes_, passes_, domain_, sampled(medium), 1.3, options) {
  light({0.3, 1, 0.2});
}

void BenchBody::light(glm::dvec3 direction) {
  std::vector<glm::vec3> gamma_s;
  for (const GpuCutCell& cell : cut_cells_) {
    const glm::dvec3 n(cell.facet.area_vector);
    const double cosine = glm::length(n) > 0 ? glm::dot(glm::normalize(n), glm::normalize(direction)) : 0.0;
    gamma_s.emplace_back(static_cast<float>(std::max(0.0, cosine)));
  }
  light_ = gpu::make_buffer(context_, gamma_s, "gamma_s");
}

}  // namespace alabaster
