#include "compare/compare.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "scene/error.h"

namespace alabaster {
namespace {

constexpr std::array<const char*, 3> rgb{"R", "G", "B"};
constexpr double file_rounding = 2e-6;
using Planes = std::array<std::vector<float>, 3>;

const std::vector<float>& channel_of(const Picture& picture, const std::string& file, const std::string& name) {
  auto found = picture.channels.find(name);
  if (found != picture.channels.end()) return found->second;
  std::string known;
  for (const auto& [other, values] : picture.channels) known += (known.empty() ? "" : ", ") + other;
  throw UserError(file + ": has no channel " + name + "; choose another --layer (channels: " + known + ")");
}

Planes layer_of(const Picture& picture, const std::string& file, const std::string& layer) {
  Planes planes;
  for (std::size_t c = 0; c < 3; ++c) {
    if (layer == "sum") {
      planes[c] = channel_of(picture, file, rgb[c]);
    } else if (layer == "subsurface") {
      planes[c] = channel_of(picture, file, rgb[c]);
      const std::vector<float>& surface = channel_of(picture, file, std::string("surface.") + rgb[c]);
      for (std::size_t i = 0; i < surface.size(); ++i) planes[c][i] -= surface[i];
    } else {
      planes[c] = channel_of(picture, file, layer + "." + rgb[c]);
    }
  }
  return planes;
}

// Adds the picture's variance of the layer, if it has one; true where it has.
bool add_variance(const Picture& picture, const std::string& layer, Planes& variance) {
  const std::string prefix = layer == "sum" ? "variance." : "variance." + layer + ".";
  if (!picture.has(prefix + "R")) return false;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::vector<float>& plane = channel_of(picture, "variance", prefix + rgb[c]);
    for (std::size_t i = 0; i < plane.size(); ++i) variance[c][i] += plane[i];
  }
  return true;
}

void make_mask(Comparison& c, const Picture& reference) {
  const auto n = static_cast<std::size_t>(c.width) * static_cast<std::size_t>(c.height);
  c.mask.assign(n, 1);
  auto object = reference.channels.find("object.Y");
  c.masked = object != reference.channels.end();
  for (std::size_t i = 0; i < n; ++i) {
    if (c.masked && !(object->second[i] > 0.999f)) c.mask[i] = 0;
    bool finite = true;
    for (std::size_t k = 0; k < 3; ++k)
      finite = finite && std::isfinite(c.test[k][i]) && std::isfinite(c.reference[k][i]);
    if (c.mask[i] && !finite) {
      c.mask[i] = 0;
      ++c.not_finite;
    }
    c.pixels += c.mask[i];
  }
  if (c.pixels == 0)
    throw UserError(c.options.reference_name +
                    ": no pixel to compare (object.Y is nowhere 1, or no value is finite); check camera and size");
}

// Figures over the channels [first, last).
Figures figures_of(const Comparison& c, std::size_t first, std::size_t last) {
  Figures f;
  std::vector<double> errors;
  errors.reserve(c.pixels * (last - first));
  double peak = 0;
  for (std::size_t k = first; k < last; ++k)
    for (std::size_t i = 0; i < c.mask.size(); ++i) {
      if (!c.mask[i]) continue;
      const double t = c.test[k][i], r = c.reference[k][i];
      f.mean_test += t;
      f.mean_reference += r;
      peak = std::max(peak, r);
      errors.push_back(std::abs(t - r));
      if (errors.back() > f.worst || errors.size() == 1) {
        f.worst = errors.back();
        f.worst_x = static_cast<int>(i) % c.width;
        f.worst_y = static_cast<int>(i) / c.width;
      }
    }
  const double n = static_cast<double>(errors.size());
  f.mean_test /= n;
  f.mean_reference /= n;
  const double m = f.mean_reference, epsilon = 0.01 * m * m;
  double square = 0;
  for (std::size_t k = first; k < last; ++k)
    for (std::size_t i = 0; i < c.mask.size(); ++i) {
      if (!c.mask[i]) continue;
      const double t = c.test[k][i], r = c.reference[k][i], d2 = (t - r) * (t - r);
      square += d2 / n;
      if (d2 > 0) f.relmse += d2 / (r * r + epsilon) / n;
    }
  f.psnr = 10 * std::log10(peak * peak / square);
  // Against a black reference a relative error has no meaning; the absolute one is given instead.
  const double unit = m > 0 ? m : 1;
  f.relative_rmse = std::sqrt(square) / unit;
  f.bias = (f.mean_test - m) / unit;
  f.worst /= unit;
  auto at95 = errors.begin() + static_cast<std::ptrdiff_t>(0.95 * (n - 1));
  std::nth_element(errors.begin(), at95, errors.end());
  f.percentile95 = *at95 / unit;
  return f;
}

ZTest z_test(const Comparison& c, const Planes& variance) {
  ZTest z;
  double n = 0, total_variance = 0, total_difference = 0, unexplained = 0;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < c.mask.size(); ++i) {
      if (!c.mask[i]) continue;
      const double t = c.test[k][i], r = c.reference[k][i], v = variance[k][i];
      n += 1;
      total_variance += v;
      total_difference += t - r;
      unexplained += (t - r) * (t - r) - v;
      if (std::abs(t - r) <= file_rounding * std::max(std::abs(t), std::abs(r))) continue;
      const double score = std::abs(t - r) / std::sqrt(v);
      z.rejected += score > 3;
      z.mean_square += score * score;
      z.largest = std::max(z.largest, score);
    }
  const double unit = c.all.mean_reference > 0 ? c.all.mean_reference : 1;
  z.rejected /= n;
  z.mean_square /= n;
  z.noise = std::sqrt(total_variance / n) / unit;
  // The three channels of a pixel come from the same paths: at worst they are one value, so the sum's variance is up to
  // three times that of independent values. The larger is taken, which makes bias_z a lower bound.
  z.bias_z = total_variance > 0 ? total_difference / std::sqrt(3 * total_variance) : 0;
  z.corrected_rmse = std::sqrt(std::max(0.0, unexplained / n)) / unit;
  return z;
}

nlohmann::json figures_json(const Figures& f) {
  return {{"mean_test", f.mean_test},
          {"mean_reference", f.mean_reference},
          {"relative_rmse", f.relative_rmse},
          {"bias", f.bias},
          {"relmse", f.relmse},
          {"psnr_db", f.psnr},
          {"percentile95", f.percentile95},
          {"worst", f.worst},
          {"worst_pixel", {f.worst_x, f.worst_y}}};
}

}  // namespace

Comparison compare(const Picture& test, const Picture& reference, const CompareOptions& options) {
  if (test.width != reference.width || test.height != reference.height)
    throw UserError(options.test_name + ": is " + std::to_string(test.width) + "x" + std::to_string(test.height) +
                    ", but " + options.reference_name + " is " + std::to_string(reference.width) + "x" +
                    std::to_string(reference.height) + "; render both with the same --size");
  Comparison c;
  c.options = options;
  c.width = test.width;
  c.height = test.height;
  c.test = layer_of(test, options.test_name, options.layer);
  c.reference = layer_of(reference, options.reference_name, options.layer);
  make_mask(c, reference);
  c.all = figures_of(c, 0, 3);
  for (std::size_t k = 0; k < 3; ++k) c.channel[k] = figures_of(c, k, k + 1);
  Planes variance;
  variance.fill(std::vector<float>(c.mask.size(), 0.0f));
  const bool of_test = add_variance(test, options.layer, variance);
  const bool of_reference = add_variance(reference, options.layer, variance);
  if (of_test || of_reference) c.z = z_test(c, variance);
  return c;
}

nlohmann::json comparison_json(const Comparison& c) {
  nlohmann::json json = figures_json(c.all);
  json["test"] = c.options.test_name;
  json["reference"] = c.options.reference_name;
  json["layer"] = c.options.layer;
  json["size"] = {c.width, c.height};
  json["pixels"] = c.pixels;
  json["mask"] = c.masked ? "object.Y > 0.999 in the reference" : "all pixels";
  json["not_finite"] = c.not_finite;
  json["relmse_epsilon"] = 0.01 * c.all.mean_reference * c.all.mean_reference;
  for (std::size_t k = 0; k < 3; ++k) json["channels"][rgb[k]] = figures_json(c.channel[k]);
  json["z_test"] = nullptr;
  if (c.z)
    json["z_test"] = {{"rejected_at_3_sigma", c.z->rejected},
                      {"mean_z_squared", c.z->mean_square},
                      {"largest_z", c.z->largest},
                      {"bias_z", c.z->bias_z},
                      {"noise", c.z->noise},
                      {"noise_corrected_rmse", c.z->corrected_rmse}};
  return json;
}

}  // namespace alabaster
