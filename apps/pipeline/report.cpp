#include "pipeline/report.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace alabaster {
namespace {

using nlohmann::json;

double worst_residual(const SolverStatus& status) {
  return *std::max_element(status.relative_residual, status.relative_residual + 3);
}

json rgb(glm::dvec3 v) { return json::array({v.r, v.g, v.b}); }

json solver_json(const ObjectReport& o) {
  return {{"cycles", o.solver.iterations},
          {"residual", worst_residual(o.solver)},
          {"converged", o.solver.converged},
          {"cells", o.domain.cut_cells + o.domain.inner_cells},
          {"levels", o.levels},
          {"channels", o.channels}};
}

json energy_json(const EnergyBalance& e) {
  return {{"in", rgb(e.in)}, {"absorbed", rgb(e.absorbed)}, {"out", rgb(e.out)}, {"imbalance", e.imbalance()}};
}

json objects_json(const RenderResult& result) {
  json list = json::array();
  for (const ObjectReport& o : result.objects)
    list.push_back({{"name", o.name},
                    {"grid", {o.cells.x, o.cells.y, o.cells.z}},
                    {"cut_cells", o.domain.cut_cells},
                    {"inner_cells", o.domain.inner_cells},
                    {"slit_cells", o.domain.slit_cells},
                    {"volume", o.domain.volume},
                    {"area", o.domain.area},
                    {"solver", solver_json(o)},
                    {"energy", energy_json(o.energy)},
                    {"reentered", rgb(o.reentered)},
                    {"gather_level", rgb(o.gather_level)}});
  return list;
}

/// All objects together: sums, and the worst of what is not a sum.
json total_solver(const RenderResult& result) {
  json total{{"cycles", 0}, {"residual", 0.0}, {"converged", true}, {"cells", 0}, {"levels", 0}};
  for (const ObjectReport& o : result.objects) {
    total["cycles"] = std::max(total["cycles"].get<int>(), o.solver.iterations);
    total["residual"] = std::max(total["residual"].get<double>(), worst_residual(o.solver));
    total["converged"] = total["converged"].get<bool>() && o.solver.converged;
    total["cells"] = total["cells"].get<std::uint64_t>() + o.domain.cut_cells + o.domain.inner_cells;
    total["levels"] = std::max(total["levels"].get<int>(), o.levels);
  }
  return total;
}

json total_energy(const RenderResult& result) {
  EnergyBalance total;
  glm::dvec3 reentered(0);
  double worst = 0;
  for (const ObjectReport& o : result.objects) {
    reentered += o.reentered;
    total.in += o.energy.in, total.absorbed += o.energy.absorbed, total.out += o.energy.out;
    worst = std::max(worst, o.energy.imbalance());
  }
  json result_json = energy_json(total);
  result_json["imbalance"] = worst;
  result_json["reentered"] = rgb(reentered);
  return result_json;
}

json plan_json(const Plan& plan) {
  json components = json::array();
  for (Component c : plan.components) components.push_back(name_of(c));
  return {{"size", {plan.size.x, plan.size.y}},
          {"camera", plan.camera.name},
          {"grid", plan.grid},
          {"tolerance", plan.tolerance},
          {"transport", name_of(plan.transport)},
          {"components", components},
          {"channels", plan.channels},
          {"light_samples", plan.light_samples},
          {"pixel_samples", plan.pixel_samples},
          {"environment_samples", plan.environment_samples},
          {"shadow_map_size", plan.shadow_map_size},
          {"interreflections", plan.interreflections},
          {"exchange_directions", plan.exchange_directions},
          {"reasons", plan.reasons}};
}

json exchange_json(const ExchangeReport& e) {
  return {{"passes", e.passes},
          {"directions", e.directions},
          {"under_way", e.under_way},
          {"rays", e.counts.rays},
          {"met_translucent", e.counts.translucent},
          {"met_opaque", e.counts.opaque},
          {"lost", e.counts.lost}};
}

}  // namespace

json stats_json(const RenderResult& result, const Plan& plan, const gpu::Context& context) {
  return {{"stages", result.stages},
          {"passes", context.timings()},
          {"solver", total_solver(result)},
          {"energy", total_energy(result)},
          {"exchange", exchange_json(result.exchange)},
          {"negative", {{"count", result.shaded.negative_pixels}, {"share", result.shaded.negative_share}}},
          {"plan", plan_json(plan)},
          {"objects", objects_json(result)},
          {"device",
           {{"name", context.info().name}, {"driver", context.info().driver}, {"peak_bytes", context.peak_bytes()}}},
          {"warnings", result.warnings}};
}

void describe(const RenderResult& result, const Plan& plan, const gpu::Context& context, Picture& picture) {
  const auto add = [&](const std::string& name, const json& value) {
    if (value.is_number())
      picture.attributes["alabaster." + name] = value.get<double>();
    else
      picture.attributes["alabaster." + name] = value.is_string() ? value.get<std::string>() : value.dump();
  };
  const json groups{{"plan", plan_json(plan)}, {"solver", total_solver(result)}, {"energy", total_energy(result)}};
  for (auto& [group, values] : groups.items())
    for (auto& [name, value] : values.items()) add(group + "." + name, value);
  for (auto& [name, value] : result.stages) add("stage." + name, value);
  add("negative.count", result.shaded.negative_pixels);
  add("device", context.info().name);
}

}  // namespace alabaster
