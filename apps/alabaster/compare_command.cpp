#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "arguments.h"
#include "commands.h"
#include "compare/compare.h"
#include "image/whole_file.h"

namespace alabaster {
namespace {

struct Arguments {
  std::string test, reference, sheet, json;
  CompareOptions options;
};

void run(const Arguments& a) {
  CompareOptions options = a.options;
  options.test_name = a.test;
  options.reference_name = a.reference;
  for (const std::string& path : {a.sheet, a.json})
    if (!path.empty()) check_writable(path);
  const Picture test = read_exr(a.test), reference = read_exr(a.reference);
  const Comparison result = compare(test, reference, options);
  std::printf(
      "%zu pixels, layer %s: relative RMSE %.2f %%, bias %+.2f %%, PSNR %.1f dB, 95th percentile %.2f %%, worst %.1f "
      "%% at (%d, %d)\n",
      result.pixels, options.layer.c_str(), 100 * result.all.relative_rmse, 100 * result.all.bias, result.all.psnr,
      100 * result.all.percentile95, 100 * result.all.worst, result.all.worst_x, result.all.worst_y);
  for (int c = 0; c < 3; ++c)
    std::printf("  %c: relative RMSE %.2f %%, bias %+.2f %%\n", "RGB"[c], 100 * result.channel[c].relative_rmse,
                100 * result.channel[c].bias);
  if (result.z)
    std::printf("  Z-test: %.2f %% of the pixels beyond 3 sigma; relative RMSE without the reference's noise %.2f %%\n",
                100 * result.z->rejected, 100 * result.z->corrected_rmse);
  if (!a.json.empty()) write_whole_file(a.json, comparison_json(result).dump(2) + "\n");
  if (!a.sheet.empty()) write_sheet(result, a.sheet);
}

}  // namespace

void add_compare(CLI::App& app) {
  auto* command =
      app.add_subcommand("compare", "error figures of a picture against a reference, and a sheet that shows them");
  auto a = std::make_shared<Arguments>();
  command->add_option("test", a->test, "picture to judge (EXR)")->required();
  command->add_option("reference", a->reference, "reference picture (EXR)")->required();
  command->add_option("-o,--output", a->sheet, "comparison sheet (PNG)");
  command->add_option("--json", a->json, "figures (JSON)");
  command->add_option("--layer", a->options.layer, "sum, subsurface, or a layer's name")->capture_default_str();
  command->callback([a] { run(*a); });
}

}  // namespace alabaster
