#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_easy_font.h>
#pragma GCC diagnostic pop

#include <algorithm>
#include <cmath>

#include "compare/canvas.h"

namespace alabaster {
namespace {

unsigned char encode(double linear) {
  const double x = std::clamp(linear, 0.0, 1.0);
  return static_cast<unsigned char>(
      std::lround(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055)));
}

}  // namespace

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

void draw(Canvas& canvas, const Panel& panel, const std::function<Colour(std::size_t)>& colour) {
  for (int y = 0; y < panel.zoom * panel.height; ++y)
    for (int x = 0; x < panel.zoom * panel.width; ++x) {
      const auto pixel = static_cast<std::size_t>(y / panel.zoom) * static_cast<std::size_t>(panel.width) +
                         static_cast<std::size_t>(x / panel.zoom);
      const Colour shown = colour(pixel);
      for (std::size_t k = 0; k < 3; ++k) canvas.at(panel.x + x, panel.y + y)[k] = encode(shown[k]);
    }
}

double exposure_of(const std::array<std::vector<float>, 3>& planes, const std::vector<unsigned char>& mask) {
  std::vector<float> values;
  for (const std::vector<float>& plane : planes)
    for (std::size_t i = 0; i < mask.size(); ++i)
      if (mask[i]) values.push_back(plane[i]);
  auto at99 = values.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at99, values.end());
  return *at99 > 0 ? 0.9 / static_cast<double>(*at99) : 1.0;
}

}  // namespace alabaster
