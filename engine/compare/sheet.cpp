#include <algorithm>
#include <cmath>
#include <cstdio>

#include "compare/canvas.h"
#include "compare/compare.h"

namespace alabaster {
namespace {

constexpr double signed_range = 0.25;  // of the reference's mean

// White at 0, blue at -1, red at +1.
Colour diverging(double s) {
  const double t = std::clamp(std::abs(s), 0.0, 1.0);
  const Colour end = s < 0 ? Colour{0.02, 0.10, 0.55} : Colour{0.55, 0.02, 0.03};
  return {1 - t * (1 - end[0]), 1 - t * (1 - end[1]), 1 - t * (1 - end[2])};
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
  const double gain = exposure_of(c.reference, c.mask);
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
    draw(canvas, {p * panel_width, line_height, c.width, c.height, zoom}, panels[static_cast<std::size_t>(p)]);
  }
  int y = line_height + panel_height + 6;
  for (const std::string& line : lines) {
    write_text(canvas, 4, y, line);
    y += line_height;
  }
  write_png_rgb8(canvas.width, canvas.height, canvas.rgb, path);
}

}  // namespace alabaster
