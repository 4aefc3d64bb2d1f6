// What a table of accuracy comes to: one row for each transport, grid and layer.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace alabaster {

/// The reference's noise taken out where it is known.
double rmse_of(const nlohmann::json& figures);

/// `figures`: those of Verdict, in any order. Over the scenes: median RMSE, median of the bias without its sign, worst
/// RMSE and its scene, percent; and the least and the largest RMSE over that of `report` on the same grid among scenes
/// lit from behind (-: there are none, or no report). A Markdown table, empty where there are no two scenes.
std::string summary_of(const nlohmann::json& figures);

}  // namespace alabaster
