// How far one picture is from another, in figures that separate noise from bias, and as a sheet to look at.
#pragma once

#include <array>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "image/picture.h"

namespace alabaster {

struct CompareOptions {
  /// "sum" (R, G, B), "subsurface" (the sum less `surface`) or the name of a layer in both pictures ("multiple", ...).
  std::string layer = "sum";
  std::string test_name = "test", reference_name = "reference";  // for messages and for the sheet
};

/// Figures of one channel, or of the three together, over the n values of the mask; t test, r reference, m = mean(r).
struct Figures {
  double mean_test = 0, mean_reference = 0;  // W/m^2/sr
  double relative_rmse = 0;                  // sqrt(mean (t - r)^2) / m
  double bias = 0;                           // (mean(t) - m) / m, signed
  double relmse = 0;                         // mean (t - r)^2 / (r^2 + epsilon), epsilon = 0.01 m^2
  double psnr = 0;                           // dB, 10 log10(max(r)^2 / mean (t - r)^2)
  double percentile95 = 0;                   // 95th percentile of |t - r| / m
  double worst = 0;                          // largest |t - r| / m
  int worst_x = 0, worst_y = 0;              // where, from the top left
};

/// Per-pixel Z-test, z = (t - r) / sqrt(var t + var r), with the pictures' own variances of the pixel means (a picture
/// without variance layers counts as exact). Chance alone rejects 0.27 % at 3 sigma. After K. Subr, J. Arvo,
/// "Statistical Hypothesis Testing for Assessing Monte Carlo Estimators", 2007. Differences below 2e-6 of the value
/// count as none: the files' own rounding.
struct ZTest {
  double rejected = 0;        // share with |z| > 3
  double mean_square = 0;     // mean z^2: 1 where noise explains all
  double largest = 0;         // max |z|
  double bias_z = 0;          // (mean t - mean r) in standard errors of that difference
  double noise = 0;           // sqrt(mean (var t + var r)) / m
  double corrected_rmse = 0;  // sqrt(max(0, mean((t - r)^2 - var t - var r))) / m: the RMSE that is not noise
};

struct Comparison {
  CompareOptions options;
  int width = 0, height = 0;
  std::array<std::vector<float>, 3> test, reference;  // the compared layer's planes
  std::vector<std::uint8_t> mask;                     // 1 where a pixel counts
  bool masked = false;                                // false: the reference has no object.Y, every pixel counts
  std::size_t pixels = 0;                             // in the mask
  std::size_t not_finite = 0;                         // pixels left out because a value is not a number
  Figures all;                                        // of R, G and B taken together
  std::array<Figures, 3> channel;
  std::optional<ZTest> z;  // where a picture has a variance of the layer
};

/// Compares over the pixels whose `object.Y` in the reference exceeds 0.999 (all of them without that channel). Any
/// picture with R, G, B will do. Throws UserError where sizes differ, a layer is missing, or the mask is empty.
Comparison compare(const Picture& test, const Picture& reference, const CompareOptions& options = {});

nlohmann::json comparison_json(const Comparison& comparison);

/// test | reference | 4 x |error| | signed error as 8-bit PNG, with the figures written below. One exposure for the
/// first three panels: the reference's 99th percentile over the mask is shown as 0.9. The signed error, averaged over
/// the channels, runs from blue
/// (-25 % of the mean) over white to red (+25 %).
void write_sheet(const Comparison& comparison, const std::string& path);

}  // namespace alabaster
