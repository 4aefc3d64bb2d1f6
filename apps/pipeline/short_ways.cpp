#include "pipeline/short_ways.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace alabaster {

namespace {
constexpr double margin = 2.5;  // cells beside the object: choose_frame()
}

std::string short_ways_warning(const MediumSamples& medium, const GridFrame& frame, int grid) {
  std::vector<double> shorter;  // the shortest of a facet's channels, cells
  for (std::size_t i = 1; i < medium.facets.size(); ++i) {
    double length = INFINITY;
    for (int c = 0; c < medium.channels; ++c) {
      const double kappa = medium.facets[i].kappa[c], sigma_a = medium.facets[i].sigma_a[c];
      if (sigma_a > 0) length = std::min(length, std::sqrt(kappa / sigma_a) / frame.h);
    }
    if (length < 1) shorter.push_back(length);
  }
  const std::size_t facets = medium.facets.size() > 1 ? medium.facets.size() - 1 : 0;
  if (20 * shorter.size() <= facets) return "";
  std::sort(shorter.begin(), shorter.end());
  const double length = shorter[shorter.size() / 10];
  char text[240];
  std::snprintf(
      text, sizeof text,
      "light goes less far than a cell below %.0f %% of its surface (diffusion length %.2g of a cell of %.3g mm): "
      "mottling of the grid shows; --grid %d resolves it",
      100.0 * double(shorter.size()) / double(facets), length, 1000.0 * frame.h,
      int(std::ceil((grid - margin) / length + margin)));
  return text;
}

}  // namespace alabaster
