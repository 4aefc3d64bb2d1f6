#include "diffusion/face_kappa.h"

#include <algorithm>

#include "diffusion/medium_samples.h"

namespace alabaster {
namespace {

struct Half {  // the way through one cell
  const FaceSide& cell;
  double lengths[most_samples_an_axis];  // h: of the way from the unknown to the face in each row of samples
};

/// The way leads from the unknown to the cell's low (up = 0) or high face.
Half half(const Pattern& pattern, const FaceSide& cell, int up) {
  const double distance = std::max(up ? 1 - cell.centre : cell.centre, least_distance);
  const double reach = std::min(distance, 1.0), low = up ? 1 - reach : 0, high = up ? 1 : reach;
  Half half{cell, {}};
  for (int s = 0; s < pattern.m(); ++s) {
    const double overlap = std::min(high, (s + 1.0) / pattern.m()) - std::max(low, double(s) / pattern.m());
    half.lengths[s] = std::max(0.0, overlap) * distance / reach;
  }
  return half;
}

}  // namespace

/// Between two bounds. The lower, by Thomson's principle: flux that keeps to its columns, in the shares that the
/// whole of both cells suggests; so a sheet across the columns, which may begin on this side of the unknown in one
/// and beyond it in another, is not passed by changing columns half way. The upper, by Dirichlet's: phi falls evenly,
/// which is right for sheets along the flux. Where sheets across it part the two widely the lower is right.
glm::dvec3 face_kappa(const Pattern& pattern, const FaceSide& lower, const FaceSide& upper, int axis) {
  const Half halves[2] = {half(pattern, lower, 1), half(pattern, upper, 0)};
  const int m = pattern.m();
  glm::dvec3 flux(0), spent(0), even(0);
  double lengths = 0;
  for (int column = 0; column < m * m; ++column) {
    double length = 0;
    int count = 0;
    glm::dvec3 resistance(0), whole(0);
    for (const Half& half : halves)
      for (int s = 0; s < m; ++s) {
        const int sample = pattern.in_column(axis, s, column % m, column / m);
        if (!(half.cell.solid >> sample & 1)) continue;
        const glm::dvec3 here(half.cell.resistivity[sample]);
        whole += here;
        ++count;
        length += half.lengths[s];
        resistance += half.lengths[s] * here;
        even += half.lengths[s] / here;
      }
    if (length <= 0) continue;
    const glm::dvec3 share = length * double(count) / whole;
    flux += share;
    spent += share * share * resistance / (length * length);
    lengths += length;
  }
  if (lengths > 0) {
    const glm::dvec3 least = flux * flux / (spent * lengths), most = even / lengths;
    if (m == 1) return least;
    const Texture &one = *lower.texture, &two = *upper.texture;
    const glm::dvec3 variance = glm::max(one.variance + two.variance, glm::dvec3(1e-12));
    return glm::mix(least, most, glm::smoothstep(0.2, 0.5, (one.steps[axis] + two.steps[axis]) / variance));
  }
  glm::dvec3 sum(0);  // no sample on the way: all of both cells in series
  int count = 0;
  for (const Half& half : halves)
    for (int s = 0; s < pattern.count(); ++s)
      if (half.cell.solid >> s & 1) sum += glm::dvec3(half.cell.resistivity[s]), ++count;
  return double(count) / sum;
}

}  // namespace alabaster
