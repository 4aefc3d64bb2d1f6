#include "scene/mesh_edges.h"

#include <algorithm>

namespace alabaster {

std::uint64_t edge_key(unsigned a, unsigned b) { return std::uint64_t(std::min(a, b)) << 32 | std::max(a, b); }

EdgeTable::EdgeTable(const Mesh& mesh) {
  list_.reserve(3 * mesh.triangles.size());
  for (unsigned t = 0; t < mesh.triangles.size(); ++t)
    for (unsigned char side = 0; side < 3; ++side) {
      unsigned a = mesh.triangles[t][side], b = mesh.triangles[t][(side + 1) % 3];
      list_.push_back({edge_key(a, b), t, side, a < b});
    }
  std::sort(list_.begin(), list_.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return a.edge != b.edge ? a.edge < b.edge : a.triangle < b.triangle;
  });
}

bool EdgeTable::contains(unsigned a, unsigned b) const {
  std::uint64_t key = edge_key(a, b);
  auto found = std::lower_bound(list_.begin(), list_.end(), key,
                                [](const HalfEdge& half, std::uint64_t wanted) { return half.edge < wanted; });
  return found != list_.end() && found->edge == key;
}

}  // namespace alabaster
