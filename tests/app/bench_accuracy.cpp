// The table of `alabaster-bench accuracy` by layers: which cells hold figures, and that these are those of
// `alabaster compare`.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/program.h"

namespace alabaster {
namespace {

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  for (std::size_t at = 1, end; (end = line.find('|', at)) != std::string::npos; at = end + 1) {
    const std::string cell = line.substr(at, end - at);
    const std::size_t first = cell.find_first_not_of(' ');
    cells.push_back(first == std::string::npos ? "" : cell.substr(first, cell.find_last_not_of(' ') - first + 1));
  }
  return cells;
}

std::vector<std::vector<std::string>> table_of(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  for (std::size_t at = 0, end; (end = text.find('\n', at)) != std::string::npos; at = end + 1)
    rows.push_back(cells_of(text.substr(at, end - at)));
  return rows;
}

TEST(BenchAccuracy, LayersSideBySide) {
  const test::TempFolder folder;
  const std::string scene = "sphere-homogeneous-10mfp-1.3", kept = folder / "kept";
  const test::Outcome outcome = test::run_program(
      "alabaster-bench", {"accuracy", "--scenes", scene, "--size", "16x12", "--spp", "4", "--grid", "12", "--transport",
                          "report,as-printed", "--layers", "subsurface,multiple,single", "--references", kept,
                          "--sheets", folder / "sheets", "--gallery", folder / "all.jpg"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto rows = table_of(outcome.out);
  ASSERT_EQ(rows.size(), 4u) << outcome.out;
  EXPECT_EQ(rows[0], (std::vector<std::string>{"scene", "transport", "subsurface", "multiple", "single", "noise"}));
  EXPECT_EQ(rows[2][1], "report");
  EXPECT_NE(rows[2][4].find("*"), std::string::npos) << "a layer without variance must say so: " << outcome.out;
  // The query as printed has no single scattering apart, so neither `single` nor `multiple` can be compared.
  EXPECT_EQ(rows[3][1], "as-printed");
  EXPECT_EQ(rows[3][3], "-");
  EXPECT_EQ(rows[3][4], "-");
  EXPECT_TRUE(std::filesystem::exists(folder / "all.jpg"));

  for (int layer = 0; layer < 3; ++layer) {
    const std::string name = rows[0][static_cast<std::size_t>(2 + layer)], json = folder / "figures.json";
    ASSERT_EQ(test::run_program("alabaster", {"compare", folder / "sheets" + ("/" + scene) + "-report-12.exr",
                                              kept + "/" + scene + ".exr", "--layer", name, "--json", json})
                  .status,
              0);
    const std::string& cell = rows[2][static_cast<std::size_t>(2 + layer)];
    const double bias = std::strtod(cell.c_str() + cell.find('/') + 1, nullptr);
    EXPECT_NEAR(bias, 100 * nlohmann::json::parse(read_file(json)).at("bias").get<double>(), 0.1) << name;
  }
}

}  // namespace
}  // namespace alabaster
