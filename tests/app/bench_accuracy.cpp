// The table of `alabaster-bench accuracy` by layers: which cells hold figures, and that these are those of
// `alabaster compare`.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "image/picture.h"
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
  const std::vector<std::string> arguments{"accuracy",
                                           "--scenes",
                                           scene,
                                           "--size",
                                           "16x12",
                                           "--spp",
                                           "4",
                                           "--grid",
                                           "12",
                                           "--transport",
                                           "report,as-printed",
                                           "--layers",
                                           "subsurface,multiple,single",
                                           "--references",
                                           kept,
                                           "--sheets",
                                           folder / "sheets",
                                           "--gallery",
                                           folder / "all.jpg"};
  const test::Outcome outcome = test::run_program("alabaster-bench", arguments);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto rows = table_of(outcome.out);
  ASSERT_EQ(rows.size(), 4u) << outcome.out << "one scene has no summary";
  EXPECT_EQ(rows[0], (std::vector<std::string>{"scene", "transport", "subsurface", "multiple", "single", "noise"}));
  EXPECT_EQ(rows[2][1], "report");
  // The query as printed has no single scattering apart, so neither `single` nor `multiple` can be compared.
  EXPECT_EQ(rows[3][1], "as-printed");
  EXPECT_EQ(rows[3][3], "-");
  EXPECT_EQ(rows[3][4], "-");
  EXPECT_TRUE(std::filesystem::exists(folder / "all.jpg"));

  const std::string reference = kept + "/" + scene + ".exr";
  std::string noises;
  for (int layer = 0; layer < 3; ++layer) {
    const std::string name = rows[0][static_cast<std::size_t>(2 + layer)], json = folder / "figures.json";
    ASSERT_EQ(test::run_program("alabaster", {"compare", folder / "sheets" + ("/" + scene) + "-report-12.exr",
                                              reference, "--layer", name, "--json", json})
                  .status,
              0);
    const std::string& cell = rows[2][static_cast<std::size_t>(2 + layer)];
    const nlohmann::json figures = nlohmann::json::parse(read_file(json));
    EXPECT_NEAR(std::strtod(cell.c_str(), nullptr), 100 * figures["z_test"]["noise_corrected_rmse"].get<double>(), 0.1)
        << name;
    EXPECT_NEAR(std::strtod(cell.c_str() + cell.find('/') + 1, nullptr), 100 * figures["bias"].get<double>(), 0.1)
        << name;
    char noise[32];
    std::snprintf(noise, sizeof noise, "%s%.1f", layer ? " / " : "", 100 * figures["z_test"]["noise"].get<double>());
    noises += noise;
  }
  EXPECT_EQ(rows[2][5], noises);

  Picture without = read_exr(reference);  // as references were once
  for (const char* channel : {"R", "G", "B"}) without.channels.erase(std::string("variance.single.") + channel);
  write_exr(without, reference);
  std::filesystem::remove(reference + ".state");
  const auto again = table_of(test::run_program("alabaster-bench", arguments).out);
  ASSERT_EQ(again.size(), 4u);
  EXPECT_EQ(again[2][3], rows[2][3]);
  EXPECT_NE(again[2][4].find("*"), std::string::npos) << "a layer without variance must say so";
}

TEST(BenchAccuracy, SummaryOfSeveralScenes) {
  const test::TempFolder folder;
  const std::string front = "sphere-homogeneous-10mfp-1.3", back = front + "-back", side = front + "-punctual";
  const test::Outcome outcome = test::run_program(
      "alabaster-bench", {"accuracy", "--scenes", front + "," + back + "," + side, "--size", "16x12", "--spp", "4",
                          "--grid", "12", "--transport", "report,gather", "--json", folder / "all.json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto rows = table_of(outcome.out);
  ASSERT_EQ(rows.size(), 10u)
      << outcome.out;  // head and rule, three scenes, a line between, head and rule, two renders
  double rmse[2][3], bias[2][3];
  for (const nlohmann::json& f : nlohmann::json::parse(read_file(folder / "all.json"))) {
    const int gather = f["transport"] == "gather", scene = f["scene"] == front ? 0 : f["scene"] == back ? 1 : 2;
    rmse[gather][scene] = 100 * f["z_test"]["noise_corrected_rmse"].get<double>();
    bias[gather][scene] = std::abs(100 * f["bias"].get<double>());
  }
  const auto middle = [](const double* v) {
    return std::max(std::min(v[0], v[1]), std::min(std::max(v[0], v[1]), v[2]));
  };
  for (int gather = 0; gather < 2; ++gather) {
    const std::vector<std::string>& row = rows[8 + static_cast<std::size_t>(gather)];
    EXPECT_EQ(row[0], gather ? "gather" : "report");
    EXPECT_EQ(row[3], "3");
    EXPECT_NEAR(std::stod(row[4]), middle(rmse[gather]), 0.051);
    EXPECT_NEAR(std::stod(row[5]), middle(bias[gather]), 0.051);
    const double* worst = std::max_element(rmse[gather], rmse[gather] + 3);
    EXPECT_NEAR(std::stod(row[6]), *worst, 0.051);
    const std::string scenes[] = {front, back, side};
    EXPECT_EQ(row[6].substr(row[6].find(' ') + 1), scenes[worst - rmse[gather]]);
  }
  EXPECT_EQ(rows[8][7], "-");
  EXPECT_NEAR(std::stod(rows[9][7]), rmse[1][1] / rmse[0][1], 0.0051);  // of the one lit from behind alone
}

}  // namespace
}  // namespace alabaster
