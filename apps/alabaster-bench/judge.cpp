#include "judge.h"

#include <algorithm>

#include "compare/compare.h"

namespace alabaster {
namespace {

namespace fs = std::filesystem;

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// A picture that says it has enough samples and whose run left nothing to go on from is taken as it is.
bool finished(const std::string& reference, int spp) {
  if (!fs::exists(reference) || fs::exists(reference + ".state")) return false;
  const Picture picture = read_exr(reference);
  const auto samples = picture.attributes.find("samplesPerPixel");
  const auto* number = samples == picture.attributes.end() ? nullptr : std::get_if<double>(&samples->second);
  return number && *number >= spp;
}

std::vector<std::string> with_components(const JudgeOptions& o) {
  std::vector<std::string> words = o.render_options;
  if ((contains(o.layers, "single") || contains(o.layers, "multiple")) && !contains(words, "--components"))
    words.insert(words.end(), {"--components", "multiple,single,surface"});
  return words;
}

}  // namespace

bool comparable(const Picture& test, const Picture& reference, const std::string& layer) {
  const auto both = [&](const std::string& channel) { return test.has(channel) && reference.has(channel); };
  if (layer == "sum") return both("R");
  if (layer == "subsurface") return both("R") && both("surface.R");
  return both(layer + ".R") && (layer != "multiple" || both("single.R"));
}

Judge::Judge(const JudgeOptions& options)
    : options_(options),
      folder_(options.references.empty() ? scratch_ / "" : options.references + "/"),
      render_options_(with_components(options)) {
  fs::create_directories(folder_);
}

std::vector<Verdict> Judge::operator()(const std::string& name) const {
  const std::string scene = folder_ + name + ".glb", reference_file = reference_of(name),
                    test_file = scratch_ / "test.exr";
  run_sibling("alabaster-scenes", {folder_, "--meshes", options_.meshes, "--names", name});
  if (!finished(reference_file, options_.spp))
    run_sibling("alabaster", {"reference", scene, "-o", reference_file, "--size", options_.size, "--spp",
                              std::to_string(options_.spp), "--resume"});
  const Picture reference = read_exr(reference_file);
  std::vector<Verdict> all;
  for (const std::string& transport : options_.transports)
    for (const std::string& grid : options_.grids) {
      std::vector<std::string> words{"render",      scene,    "-o", test_file,     "--size",
                                     options_.size, "--grid", grid, "--transport", transport};
      words.insert(words.end(), render_options_.begin(), render_options_.end());
      run_sibling("alabaster", words);
      Verdict verdict{name, transport, grid, read_exr(test_file), {}};
      for (const std::string& layer : options_.layers) {
        std::optional<nlohmann::json> figures;
        if (comparable(verdict.test, reference, layer)) {
          figures = comparison_json(compare(verdict.test, reference,
                                            {.layer = layer,
                                             .test_name = name + ", " + transport + ", grid " + grid,
                                             .reference_name = reference_file}));
          (*figures)["scene"] = name, (*figures)["transport"] = transport, (*figures)["grid"] = grid;
        }
        verdict.figures.push_back(std::move(figures));
      }
      all.push_back(std::move(verdict));
    }
  return all;
}

}  // namespace alabaster
