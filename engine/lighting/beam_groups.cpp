#include "lighting/beam_groups.h"

#include <algorithm>

namespace alabaster {
namespace {

constexpr double widest = 0.15;  // tangent of half a group's width

/// Where a sample is: of parallel light on the unit sphere of directions.
glm::dvec3 place_of(const LightSample& sample) {
  return sample.kind == light_directional ? -sample.normal : sample.position;
}

double distance_to(const LightSample& sample, const GridFrame& frame, glm::dvec3 from) {
  if (sample.kind == light_directional) return 1;
  const glm::dvec3 low = frame.origin, high = low + double(frame.h) * glm::dvec3(frame.cells);
  return glm::length(glm::max(glm::max(low - from, from - high), glm::dvec3(0)));
}

using Samples = std::vector<LightSample>::const_iterator;

bool narrow(Samples first, Samples end, const GridFrame& frame) {
  glm::dvec3 middle(0);
  for (auto s = first; s != end; ++s) middle += place_of(*s) / double(end - first);
  const double most = widest * distance_to(*first, frame, middle);
  return std::all_of(first, end, [&](const LightSample& s) { return glm::distance(place_of(s), middle) <= most; });
}

void add_groups(Samples first, Samples end, const GridFrame& frame, std::vector<std::uint32_t>& sizes) {
  if (end - first > 1 && !narrow(first, end, frame)) {
    const Samples middle = first + (end - first) / 2;
    add_groups(first, middle, frame, sizes);
    add_groups(middle, end, frame, sizes);
  } else if (first != end) {
    sizes.push_back(static_cast<std::uint32_t>(end - first));
  }
}

}  // namespace

std::vector<std::uint32_t> beam_groups(const LightSamples& lights, const GridFrame& frame) {
  std::vector<std::uint32_t> sizes;
  for (Samples first = lights.area.begin(); first != lights.area.end();) {
    const Samples end = std::find_if(first, lights.area.end(), [&](const LightSample& s) {
      return s.kind != first->kind || s.object != first->object;
    });
    add_groups(first, end, frame, sizes);
    first = end;
  }
  return sizes;
}

}  // namespace alabaster
