// 8-bit pictures to look at: panels of linear colour, and text below them.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace alabaster {

using Colour = std::array<double, 3>;  // linear, 0..1 is shown

constexpr int line_height = 14;  // px, of a line of text

struct Canvas {
  int width, height;               // px
  std::vector<unsigned char> rgb;  // 3 a pixel, row-major from the top; dark grey where nothing is drawn
  Canvas(int w, int h) : width(w), height(h), rgb(3 * static_cast<std::size_t>(w) * static_cast<std::size_t>(h), 24) {}
  unsigned char* at(int x, int y) {
    return &rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x))];
  }
};

/// Where a panel stands on the canvas and how many of its own pixels it has; each is drawn `zoom` x `zoom` px large.
struct Panel {
  int x, y, width, height, zoom;
};

/// `colour` gives each pixel of the panel by its index, row-major from the top; it is shown through the sRGB curve.
void draw(Canvas& canvas, const Panel& panel, const std::function<Colour(std::size_t)>& colour);

void write_text(Canvas& canvas, int x, int y, std::string text);

/// The factor that shows the 99th percentile of `planes` (R, G, B together) where `mask` is not 0 as 0.9.
double exposure_of(const std::array<std::vector<float>, 3>& planes, const std::vector<unsigned char>& mask);

}  // namespace alabaster
