// Reading values out of a JSON object with errors that name the file and the field.
#pragma once

#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace alabaster {

/// A JSON object and where it stands. Every read checks kind and finiteness; errors are UserErrors
/// "file: material 'x': extras.medium.sigma_s must be ...".
class Fields {
 public:
  Fields(nlohmann::json object, std::string file, std::string path);

  bool has(const std::string& key) const { return json_.contains(key); }
  bool is_object(const std::string& key) const { return has(key) && json_[key].is_object(); }
  double number(const std::string& key) const;
  double number_or(const std::string& key, double fallback) const { return has(key) ? number(key) : fallback; }
  /// [r, g, b], or one number for grey.
  glm::dvec3 rgb(const std::string& key) const;
  glm::dvec3 rgb_or(const std::string& key, glm::dvec3 fallback) const { return has(key) ? rgb(key) : fallback; }
  /// [r, g, b, a].
  glm::dvec4 rgba(const std::string& key) const;
  /// [x, y, z].
  glm::dvec3 point(const std::string& key) const;
  std::vector<double> numbers(const std::string& key, std::size_t count) const;
  /// The objects of a list.
  std::vector<Fields> list(const std::string& key) const;
  std::string text(const std::string& key) const;
  bool flag(const std::string& key) const;  // false where there is none
  /// "filter" of a grid: "trilinear", as without it, or "nearest".
  bool trilinear() const;
  /// "bbox_min" and "bbox_max": positions -> the unit cube that the box between them becomes.
  glm::dmat4 box() const;
  /// The object under `key`; an empty one where there is none.
  Fields child(const std::string& key) const;
  const std::string& file() const { return file_; }

  /// Throws "file: path.key what"; an empty key names the object itself.
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;

 private:
  std::string path_of(const std::string& key) const;
  const nlohmann::json& need(const std::string& key, const char* what) const;

  nlohmann::json json_;
  std::string file_, path_;
};

}  // namespace alabaster
