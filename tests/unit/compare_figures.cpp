#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <random>

#include "compare/compare.h"
#include "scene/error.h"
#include "support/pictures.h"

namespace alabaster {
namespace {

TEST(Compare, FiguresOfKnownErrors) {
  Picture reference = constant(10, 10, 2.0f), test = constant(10, 10, 2.0f);
  test.plane("R")[34] = 3.0f;  // one error of +1 in 300 values
  Comparison c = compare(test, reference);
  EXPECT_NEAR(c.all.relative_rmse, std::sqrt(1.0 / 300) / 2, 1e-12);
  EXPECT_NEAR(c.all.bias, 1.0 / 300 / 2, 1e-12);
  EXPECT_NEAR(c.all.relmse, 1.0 / 300 / (4 + 0.04), 1e-12);
  EXPECT_NEAR(c.all.psnr, 10 * std::log10(4 * 300.0), 1e-9);
  EXPECT_NEAR(c.all.worst, 0.5, 1e-12);
  EXPECT_EQ(c.all.worst_x, 4);
  EXPECT_EQ(c.all.worst_y, 3);
  EXPECT_EQ(c.all.percentile95, 0);
  EXPECT_NEAR(c.channel[0].bias, 0.01 / 2, 1e-12);
  EXPECT_EQ(c.channel[1].bias, 0);
  EXPECT_FALSE(c.z);
  nlohmann::json json = comparison_json(c);
  EXPECT_NEAR(json["channels"]["R"]["worst"].get<double>(), 0.5, 1e-12);
  EXPECT_TRUE(json["z_test"].is_null());
}

TEST(Compare, OnlyTheObjectCounts) {
  Picture reference = constant(4, 1, 1.0f), test = constant(4, 1, 1.1f);
  reference.plane("object.Y") = {1.0f, 1.0f, 0.9f, 0.0f};
  test.plane("G") = {1.1f, 1.1f, 50.0f, NAN};
  Comparison c = compare(test, reference);
  EXPECT_EQ(c.pixels, 2u);
  EXPECT_EQ(c.not_finite, 0u);
  EXPECT_NEAR(c.all.bias, 0.1, 1e-6);
  test.plane("G")[0] = NAN;
  EXPECT_EQ(compare(test, reference).not_finite, 1u);
}

TEST(Compare, Layers) {
  Picture reference = constant(3, 3, 1.0f), test = constant(3, 3, 1.0f);
  for (const char* c : {"surface.R", "surface.G", "surface.B"}) {
    reference.plane(c).assign(9, 0.25f);
    test.plane(c).assign(9, 0.5f);
  }
  EXPECT_EQ(compare(test, reference).all.bias, 0);
  EXPECT_NEAR(compare(test, reference, {.layer = "surface"}).all.bias, 1.0, 1e-6);
  EXPECT_NEAR(compare(test, reference, {.layer = "subsurface"}).all.bias, -1.0 / 3, 1e-6);
  EXPECT_THROW(compare(test, reference, {.layer = "single"}), UserError);
  EXPECT_THROW(compare(constant(2, 2, 1), reference), UserError);
}

// The Z-test tells 1 % of bias from 3 % of noise: with noise alone it rejects as often as chance does, and the error
// left after the noise's variance is taken out is the bias that was put in.
TEST(Compare, ZTestSeparatesNoiseFromBias) {
  std::mt19937 random(3);
  std::normal_distribution<float> gauss(0, 0.03f);
  auto noisy = [&](float mean) {
    Picture p = constant(200, 200, mean);
    for (const char* c : {"R", "G", "B"}) {
      for (float& v : p.plane(c)) v += gauss(random);
      p.plane(std::string("variance.") + c).assign(40000, 0.0009f);
    }
    return p;
  };
  Picture reference = noisy(1.0f);
  Comparison same = compare(noisy(1.0f), reference);
  ASSERT_TRUE(same.z);
  EXPECT_NEAR(same.z->rejected, 0.0027, 5 * std::sqrt(0.0027 / 120000));
  EXPECT_NEAR(same.z->mean_square, 1.0, 5 * std::sqrt(2.0 / 120000));
  EXPECT_LT(same.z->corrected_rmse, 0.004);
  EXPECT_LT(std::abs(same.z->bias_z), 4);
  EXPECT_NEAR(same.z->noise, 0.03 * std::sqrt(2.0), 1e-3);
  Comparison biased = compare(noisy(1.01f), reference);
  EXPECT_NEAR(biased.z->corrected_rmse, 0.01, 0.0015);
  EXPECT_GT(biased.z->bias_z, 20);
  Comparison far = compare(constant(200, 200, 1.3f), reference);
  EXPECT_GT(far.z->rejected, 0.999);
}

TEST(Compare, SheetIsWritten) {
  Picture reference = constant(40, 30, 1.0f), test = constant(40, 30, 1.05f);
  auto path =
      (std::filesystem::temp_directory_path() / ("alabaster_sheet_" + std::to_string(::getpid()) + ".png")).string();
  write_sheet(compare(test, reference, {.layer = "sum", .test_name = "render", .reference_name = "reference"}), path);
  EXPECT_GT(std::filesystem::file_size(path), 1000u);
  std::filesystem::remove(path);
  EXPECT_THROW(write_sheet(compare(test, reference), "/nonexistent/sheet.png"), UserError);
}

}  // namespace
}  // namespace alabaster
