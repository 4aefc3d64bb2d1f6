#include "summary.h"

#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include "bench.h"
#include "scene/demo_scenes.h"

namespace alabaster {
namespace {

struct Key {
  std::string transport, grid, layer;
  bool operator<(const Key& o) const {
    return std::tie(transport, grid, layer) < std::tie(o.transport, o.grid, o.layer);
  }
};

struct Group {
  Key key;
  std::map<std::string, double> rmse;  // by scene
  std::vector<double> bias;            // without sign
};

/// In the order in which they first come.
std::vector<Group> groups_of(const nlohmann::json& figures) {
  std::vector<Group> groups;
  std::map<Key, std::size_t> at;
  for (const nlohmann::json& f : figures) {
    const Key key{f.at("transport"), f.at("grid"), f.at("layer")};
    const auto [place, fresh] = at.try_emplace(key, groups.size());
    if (fresh) groups.push_back({key, {}, {}});
    Group& group = groups[place->second];
    group.rmse[f.at("scene")] = rmse_of(f);
    group.bias.push_back(std::abs(f.at("bias").get<double>()));
  }
  return groups;
}

std::string share_of(const Group& group, const std::vector<Group>& all) {
  const Group* report = nullptr;
  for (const Group& other : all)
    if (other.key.transport == "report" && other.key.grid == group.key.grid && other.key.layer == group.key.layer)
      report = &other;
  std::vector<double> shares;
  for (const auto& [scene, rmse] : group.rmse)
    if (report && report != &group && lit_from_behind(scene) && report->rmse.count(scene))
      shares.push_back(rmse / report->rmse.at(scene));
  if (shares.empty()) return "-";
  const auto [least, most] = std::minmax_element(shares.begin(), shares.end());
  char text[64];
  std::snprintf(text, sizeof text, "%.2f to %.2f", *least, *most);
  return text;
}

}  // namespace

double rmse_of(const nlohmann::json& figures) {
  const nlohmann::json& z = figures.at("z_test");
  return z.is_object() ? z.at("noise_corrected_rmse") : figures.at("relative_rmse");
}

std::string summary_of(const nlohmann::json& figures) {
  std::set<std::string> scenes;
  for (const nlohmann::json& f : figures) scenes.insert(f.at("scene").get<std::string>());
  if (scenes.size() < 2) return "";
  std::string table =
      "| transport | grid | layer | scenes | median RMSE | median bias without sign | worst RMSE | of report's error, "
      "lit from behind |\n| --- | --- | --- | --- | --- | --- | --- | --- |\n";
  const std::vector<Group> groups = groups_of(figures);
  for (const Group& group : groups) {
    std::vector<double> rmse;
    auto worst = group.rmse.begin();
    for (auto scene = group.rmse.begin(); scene != group.rmse.end(); ++scene) {
      rmse.push_back(scene->second);
      if (scene->second > worst->second) worst = scene;
    }
    char text[256];
    std::snprintf(text, sizeof text, "| %s | %s^3 | %s | %zu | %.1f | %.1f | %.1f, ", group.key.transport.c_str(),
                  group.key.grid.c_str(), group.key.layer.c_str(), rmse.size(), 100 * median(rmse),
                  100 * median(group.bias), 100 * worst->second);
    table += text + worst->first + " | " + share_of(group, groups) + " |\n";
  }
  return table;
}

}  // namespace alabaster
