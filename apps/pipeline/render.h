// All stages in a row: scene and plan in, picture and report out. The one place, beside the apps, that sees every room.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "diffusion/diffusion.h"
#include "pipeline/interreflections.h"
#include "planner/plan.h"
#include "shading/shading.h"

namespace alabaster {

/// What the solver did for one translucent object.
struct ObjectReport {
  std::string name;
  glm::ivec3 cells{0};
  DomainSummary domain;
  int levels = 0;
  int channels = 3;
  SolverStatus solver;
  // W. in: from the lamps and the environment; out: for good, that is what leaves less what enters an object again.
  // The imbalance holds what was still under way between surfaces when the passes ended.
  EnergyBalance energy;
  glm::dvec3 gather_level{1};  // GatherLevels::mean()
  glm::dvec3 reentered{0};    // W, of the light that left this object or another, or an opaque surface reflected
};

struct RenderResult {
  ShadedPicture shaded;
  std::vector<ObjectReport> objects;
  ExchangeReport exchange;
  std::map<std::string, double> stages;  // wall-clock milliseconds, by stage
  std::vector<std::string> warnings;
};

/// The pipelines that every picture needs, made once for a context. They go on being made in the background when the
/// constructor has returned.
struct Pipelines {
  explicit Pipelines(gpu::Context& context) : domains(context), solver(context), fluence(context), shading(context) {}
  DomainMaker domains;
  DiffusionPasses solver;
  FluencePasses fluence;
  Shading shading;
};

RenderResult render_scene(gpu::Context& context, const Pipelines& pipelines, const Scene& scene, const Plan& plan);
/// With pipelines of its own.
RenderResult render_scene(gpu::Context& context, const Scene& scene, const Plan& plan);

}  // namespace alabaster
