#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_easy_font.h>
#pragma GCC diagnostic pop

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "compare/compare.h"

namespace alabaster {
namespace {

using Colour = std::array<double, 3>;  // linear, 0..1 is shown
constexpr double signed_range = 0.25;  // of the reference's mean
constexpr int line_height = 14;        // px; stb_easy_font's glyphs are 7 to 10 px high

struct Canvas {
  int width, height;
  std::vector<unsigned char> rgb;
  Canvas(int w, int h) : width(w), height(h), rgb(3 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h), 24) {}
  unsigned char* at(int x, int y) {
    return &rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x))];
  }
};

unsigned char encode(double linear) {
  const double x = std::clamp(linear, 0.0, 1.0);
  return static_cast<unsigned char>(
      std::lround(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055)));
}

void write_text(Canvas& canvas, int x, int y, std::string text) {
  struct Vertex {
    float x, y, z;
    unsigned char colour[4];
  };
  std::vector<Vertex> quads(4 * 80 * (text.size() + 1));  // stb_easy_font: about 270 bytes a letter; 80 quads are ample
  const int count = stb_easy_font_print(static_cast<float>(x), static_cast<float>(y), text.data(), nullptr,
                                        quads.data(), static_cast<int>(quads.size() * sizeof(Vertex)));
  for (int q = 0; q < count; ++q) {
    const Vertex &low = quads[4 * static_cast<std::size_t>(q)], &high = quads[4 * static_cast<std::size_t>(q) + 2];
    for (int py = static_cast<int>(low.y); py < std::min(canvas.height, static_cast<int>(high.y)); ++py)
      for (int px = static_cast<int>(low.x); px < std::min(canvas.width, static_cast<int>(high.x)); ++px)
        std::fill_n(canvas.at(px, py), 3, static_cast<unsigned char>(230));
  }
}

// White at 0, blue at -1, red at +1.
Colour diverging(double s) {
  const double t = std::clamp(std::abs(s), 0.0, 1.0);
  const Colour end = s < 0 ? Colour{0.02, 0.10, 0.55} : Colour{0.55, 0.02, 0.03};
  return {1 - t * (1 - end[0]), 1 - t * (1 - end[1]), 1 - t * (1 - end[2])};
}

double exposure_of(const Comparison& c) {
  std::vector<float> values;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < c.mask.size(); ++i)
      if (c.mask[i]) values.push_back(c.reference[k][i]);
  auto at99 = values.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at99, values.end());
  return *at99 > 0 ? 0.9 / static_cast<double>(*at99) : 1.0;
}

template <class... Args>
std::string format(const char* pattern, Args... args) {
  char line[400];
  std::snprintf(line, sizeof line, pattern, args...);
  return line;
}

std::vector<std::string> lines_of(const Comparison& c) {
  std::vector<std::string> lines{format("layer %s, %zu %s, %zu left out as not finite", c.options.layer.c_str(),
                                        c.pixels, c.masked ? "object pixels" : "pixels (no mask)", c.not_finite),
                                 format("relative RMSE %.3f %%   bias %+.3f %%   95th percentile %.3f %%",
                                        100 * c.all.relative_rmse, 100 * c.all.bias, 100 * c.all.percentile95),
                                 format("relMSE %.3e   PSNR %.2f dB   worst %.2f %% at (%d, %d)", c.all.relmse,
                                        c.all.psnr, 100 * c.all.worst, c.all.worst_x, c.all.worst_y)};
  for (std::size_t k = 0; k < 3; ++k)
    lines.push_back(format("%c: RMSE %.3f %%   bias %+.3f %%   worst %.2f %%", "RGB"[k],
                           100 * c.channel[k].relative_rmse, 100 * c.channel[k].bias, 100 * c.channel[k].worst));
  if (c.z)
    lines.push_back(format("Z-test: %.2f %% beyond 3 sigma (chance 0.27 %%)   noise %.3f %%   RMSE less noise %.3f %%",
                           100 * c.z->rejected, 100 * c.z->noise, 100 * c.z->corrected_rmse));
  else
    lines.push_back("Z-test: no variance layers");
  return lines;
}

}  // namespace

void write_sheet(const Comparison& c, const std::string& path) {
  const int zoom = std::max(1, (320 + c.width - 1) / c.width);
  const int panel_width = zoom * c.width, panel_height = zoom * c.height;
  const std::vector<std::string> lines = lines_of(c);
  Canvas canvas(4 * panel_width, line_height + panel_height + line_height * static_cast<int>(lines.size() + 1));
  const double gain = exposure_of(c);
  const double unit = c.all.mean_reference > 0 ? c.all.mean_reference : 1;
  const std::array<std::string, 4> titles{
      c.options.test_name, c.options.reference_name, "4 x |error|",
      format("error, blue -%.0f %% red +%.0f %% of the mean", 100 * signed_range, 100 * signed_range)};
  const std::array<std::function<Colour(std::size_t)>, 4> panels{
      [&](std::size_t i) {
        return Colour{gain * c.test[0][i], gain * c.test[1][i], gain * c.test[2][i]};
      },
      [&](std::size_t i) {
        return Colour{gain * c.reference[0][i], gain * c.reference[1][i], gain * c.reference[2][i]};
      },
      [&](std::size_t i) {
        Colour e;
        for (std::size_t k = 0; k < 3; ++k)
          e[k] = 4 * gain * std::abs(static_cast<double>(c.test[k][i]) - c.reference[k][i]);
        return e;
      },
      [&](std::size_t i) {
        double e = 0;
        for (std::size_t k = 0; k < 3; ++k) e += (static_cast<double>(c.test[k][i]) - c.reference[k][i]) / (3 * unit);
        return c.mask[i] ? diverging(e / signed_range) : Colour{0.25, 0.25, 0.25};
      }};
  for (int p = 0; p < 4; ++p) {
    write_text(canvas, p * panel_width + 4, 3, titles[static_cast<std::size_t>(p)]);
    for (int y = 0; y < panel_height; ++y)
      for (int x = 0; x < panel_width; ++x) {
        const auto pixel =
            static_cast<std::size_t>(y / zoom) * static_cast<std::size_t>(c.width) + static_cast<std::size_t>(x / zoom);
        const Colour colour = panels[static_cast<std::size_t>(p)](pixel);
        for (std::size_t k = 0; k < 3; ++k) canvas.at(p * panel_width + x, line_height + y)[k] = encode(colour[k]);
      }
  }
  int y = line_height + panel_height + 6;
  for (const std::string& line : lines) {
    write_text(canvas, 4, y, line);
    y += line_height;
  }
  write_png_rgb8(canvas.width, canvas.height, canvas.rgb, path);
}

}  // namespace alabaster
