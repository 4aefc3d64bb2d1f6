#include "scene/fields.h"

#include <algorithm>
#include <cmath>

#include "scene/error.h"
#include "scene/shapes.h"

namespace alabaster {
namespace {

/// Whether `value` is an array of `count` finite numbers.
bool is_tuple(const nlohmann::json& value, std::size_t count) {
  auto finite = [](const nlohmann::json& v) { return v.is_number() && std::isfinite(v.get<double>()); };
  return value.is_array() && value.size() == count && std::all_of(value.begin(), value.end(), finite);
}

glm::dvec3 triple(const nlohmann::json& value) {
  return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

}  // namespace

Fields::Fields(nlohmann::json object, std::string file, std::string path)
    : json_(std::move(object)), file_(std::move(file)), path_(std::move(path)) {
  if (!json_.is_object()) throw UserError(file_ + ": " + path_ + " must be a JSON object {...}");
}

std::string Fields::path_of(const std::string& key) const {
  bool joins = path_.empty() || path_.back() == ' ' || key.empty();
  return path_ + (joins ? "" : ".") + key;
}

void Fields::fail(const std::string& key, const std::string& what) const {
  throw UserError(file_ + ": " + path_of(key) + " " + what);
}

const nlohmann::json& Fields::need(const std::string& key, const char* what) const {
  if (!has(key)) fail(key, std::string("is missing; give ") + what);
  return json_[key];
}

double Fields::number(const std::string& key) const {
  const nlohmann::json& value = need(key, "a number");
  if (!value.is_number() || !std::isfinite(value.get<double>())) fail(key, "must be a finite number");
  return value.get<double>();
}

glm::dvec3 Fields::rgb(const std::string& key) const {
  const nlohmann::json& value = need(key, "[r, g, b] or one number");
  if (value.is_number()) return glm::dvec3(number(key));
  if (!is_tuple(value, 3)) fail(key, "must be three finite numbers [r, g, b] or one number");
  return triple(value);
}

glm::dvec3 Fields::point(const std::string& key) const {
  const nlohmann::json& value = need(key, "[x, y, z]");
  if (!is_tuple(value, 3)) fail(key, "must be three finite numbers [x, y, z]");
  return triple(value);
}

glm::dvec4 Fields::rgba(const std::string& key) const {
  const nlohmann::json& value = need(key, "[r, g, b, a]");
  if (!is_tuple(value, 4)) fail(key, "must be four finite numbers [r, g, b, a]");
  return {triple(value), value[3].get<double>()};
}

std::vector<double> Fields::numbers(const std::string& key, std::size_t count) const {
  const nlohmann::json& value = need(key, "a list of numbers");
  if (!is_tuple(value, count)) fail(key, "must be a list of " + std::to_string(count) + " finite numbers");
  return value.get<std::vector<double>>();
}

std::vector<Fields> Fields::list(const std::string& key) const {
  const nlohmann::json& value = need(key, "a list of objects");
  if (!value.is_array()) fail(key, "must be a list [...]");
  std::vector<Fields> items;
  for (std::size_t i = 0; i < value.size(); ++i)
    items.emplace_back(value[i], file_, path_of(key) + "[" + std::to_string(i) + "]");
  return items;
}

bool Fields::flag(const std::string& key) const {
  if (!has(key)) return false;
  if (!json_[key].is_boolean()) fail(key, "must be true or false");
  return json_[key].get<bool>();
}

std::string Fields::text(const std::string& key) const {
  const nlohmann::json& value = need(key, "a string");
  if (!value.is_string()) fail(key, "must be a string");
  return value.get<std::string>();
}

bool Fields::trilinear() const {
  if (!has("filter")) return true;
  const std::string filter = text("filter");
  if (filter != "trilinear" && filter != "nearest") fail("filter", "must be \"trilinear\" or \"nearest\"");
  return filter == "trilinear";
}

glm::dmat4 Fields::box() const {
  const glm::dvec3 low = point("bbox_min"), high = point("bbox_max");
  if (!glm::all(glm::lessThan(low, high))) fail("bbox_max", "must be larger than bbox_min along every axis");
  return glm::inverse(translation(low) * scaling(high - low));
}

Fields Fields::child(const std::string& key) const {
  return Fields(has(key) ? json_[key] : nlohmann::json::object(), file_, path_of(key));
}

}  // namespace alabaster
