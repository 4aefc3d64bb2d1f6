// Renders of a scene held against its path-traced reference.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "image/picture.h"
#include "process.h"

namespace alabaster {

struct JudgeOptions {
  std::string meshes = "build/meshes", references, size = "160x120";
  int spp = 256;  // samples a pixel of a reference
  std::vector<std::string> transports{"report"}, grids{"64"}, layers{"subsurface"}, render_options;
};

struct Verdict {
  std::string scene, transport, grid;
  Picture test;
  /// One for each layer, as comparison_json() has them; empty where one of the pictures lacks the layer.
  std::vector<std::optional<nlohmann::json>> figures;
};

/// Whether two pictures can be compared in `layer`: both have it, and for `multiple` both have `single` apart, as a
/// `multiple` that carries single scattering is another thing than one that does not.
bool comparable(const Picture& test, const Picture& reference, const std::string& layer);

class Judge {
 public:
  explicit Judge(const JudgeOptions& options);

  /// Makes the scene, its reference where that is not finished, and a render for each transport and grid, in this
  /// order. Single scattering is drawn by itself where its layers are asked for and the render options say nothing of
  /// components.
  std::vector<Verdict> operator()(const std::string& scene) const;

  std::string reference_of(const std::string& scene) const { return folder_ + scene + ".exr"; }

 private:
  const JudgeOptions& options_;
  const Scratch scratch_;
  const std::string folder_;
  std::vector<std::string> render_options_;
};

}  // namespace alabaster
