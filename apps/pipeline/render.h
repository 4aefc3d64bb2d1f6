// All stages in a row: scene and plan in, picture and report out. The one place, beside the apps, that sees every room.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "diffusion/diffusion.h"
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
  EnergyBalance energy;  // W
};

struct RenderResult {
  ShadedPicture shaded;
  std::vector<ObjectReport> objects;
  std::map<std::string, double> stages;  // wall-clock milliseconds, by stage
  std::vector<std::string> warnings;
};

RenderResult render_scene(gpu::Context& context, const Scene& scene, const Plan& plan);

}  // namespace alabaster
