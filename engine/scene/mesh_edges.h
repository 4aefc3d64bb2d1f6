// Which triangles meet at which edge.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scene/scene.h"

namespace alabaster {

/// One side of a triangle, from corner `side` to the next.
struct HalfEdge {
  std::uint64_t edge;  // the two vertices, smaller first: equal for all triangles that share it
  unsigned triangle;
  unsigned char side;  // 0..2
  bool up;             // runs from the smaller vertex to the larger
};

/// All half-edges of a mesh, sorted so that those of one edge lie together.
class EdgeTable {
 public:
  explicit EdgeTable(const Mesh& mesh);

  /// Calls `visit(std::span<const HalfEdge>)` for every edge.
  template <typename Visit>
  void for_each(Visit visit) const {
    for (std::size_t first = 0, last; first < list_.size(); first = last) {
      for (last = first + 1; last < list_.size() && list_[last].edge == list_[first].edge;) ++last;
      visit(std::span<const HalfEdge>(list_).subspan(first, last - first));
    }
  }

  bool contains(unsigned a, unsigned b) const;

 private:
  std::vector<HalfEdge> list_;
};

std::uint64_t edge_key(unsigned a, unsigned b);

}  // namespace alabaster
