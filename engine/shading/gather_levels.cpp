#include "shading/gather_levels.h"

#include <algorithm>

namespace alabaster {
namespace {

struct Sums {
  glm::dvec3 wanted{0}, gathered{0};

  void add(double weight, const Sums& more) {
    wanted += weight * more.wanted;
    gathered += weight * more.gathered;
  }
};

glm::dvec3 ratio(const Sums& sums) {
  glm::dvec3 result(1);
  for (int c = 0; c < 3; ++c)
    if (sums.gathered[c] > 0) result[c] = sums.wanted[c] / sums.gathered[c];
  return result;
}

/// Calls back with the index of each texel that a place reads and its weight: trilinear, by the squares of the normal.
template <class Add>
void for_each_texel(glm::ivec3 nodes, double edge, glm::dvec3 position, glm::dvec3 normal, Add add) {
  const glm::dvec3 p = glm::clamp(position / edge, glm::dvec3(0), glm::dvec3(nodes - 1));
  const glm::ivec3 low = glm::min(glm::ivec3(p), glm::max(nodes - 2, 0));
  const glm::dvec3 part = p - glm::dvec3(low);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 up(corner & 1, corner >> 1 & 1, corner >> 2);
    const glm::dvec3 shares = glm::mix(1.0 - part, part, glm::dvec3(up));
    const double weight = shares.x * shares.y * shares.z;
    const glm::ivec3 node = glm::min(low + up, nodes - 1);
    for (int a = 0; a < 3; ++a) {
      const int block = 2 * a + (normal[a] < 0);
      add(node.x + std::size_t(nodes.x) * (node.y + std::size_t(nodes.y) * (node.z + std::size_t(nodes.z) * block)),
          weight * normal[a] * normal[a]);
    }
  }
}

}  // namespace

GatherLevels::GatherLevels(glm::ivec3 cells, float edge, const std::vector<GatherPlace>& places)
    : nodes_(glm::ivec3(glm::ceil(glm::vec3(cells) / edge)) + 1), edge_(edge) {
  std::vector<Sums> sums(6 * std::size_t(nodes_.x) * nodes_.y * nodes_.z);
  Sums all;
  for (const GatherPlace& place : places) {
    const Sums here{place.flux.wanted, place.flux.gathered};
    all.add(1, here);
    for_each_texel(nodes_, edge_, place.position, place.normal,
                   [&](std::size_t texel, double weight) { sums[texel].add(weight, here); });
  }
  mean_ = ratio(all);
  // A tenth of one place's worth of the mean: where there is next to no light.
  for (Sums& node : sums) {
    node.add(0.1 / std::max<double>(double(places.size()), 1), all);
    texels_.emplace_back(glm::vec4(ratio(node), 1));
  }
  Sums levelled;
  for (const GatherPlace& place : places)
    levelled.gathered += at(place.position, place.normal) * glm::dvec3(place.flux.gathered);
  levelled.wanted = all.wanted;
  const glm::vec4 scale(ratio(levelled), 1);
  for (glm::vec4& texel : texels_) texel *= scale;
}

glm::dvec3 GatherLevels::at(glm::dvec3 position, glm::dvec3 normal) const {
  glm::dvec3 level(0);
  for_each_texel(nodes_, edge_, position, normal,
                 [&](std::size_t texel, double weight) { level += weight * glm::dvec3(texels_[texel]); });
  return level;
}

}  // namespace alabaster
