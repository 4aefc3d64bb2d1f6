#include "lighting/triangle_tree.h"

#include <algorithm>
#include <bit>
#include <span>

#include "shared/exchange.h"

namespace alabaster {

static_assert(sizeof(TreeBox) == 24 && sizeof(TreeTriangle) == 40);

namespace {

constexpr std::size_t most_leaf_triangles = 4;

glm::vec3 middle(const TreeTriangle& t) { return (t.a + t.b + t.c) / 3.0f; }

/// Orders the triangles of a node with `leaves` leaves below it.
void halve(std::span<TreeTriangle> triangles, std::size_t leaves) {
  if (leaves == 1) return;
  Bounds bounds;
  for (const TreeTriangle& t : triangles) bounds.add(middle(t));
  const glm::vec3 size = bounds.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t half = triangles.size() / 2;
  std::nth_element(triangles.begin(), triangles.begin() + half, triangles.end(),
                   [&](const TreeTriangle& a, const TreeTriangle& b) { return middle(a)[axis] < middle(b)[axis]; });
  halve(triangles.first(half), leaves / 2);
  halve(triangles.subspan(half), leaves / 2);
}

std::vector<TreeTriangle> all_triangles(const Scene& scene) {
  std::vector<TreeTriangle> triangles;
  for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
    const Mesh& mesh = scene.objects[o].mesh;
    const std::uint32_t flag = scene.objects[o].role == Role::translucent ? tree_closed : 0;
    for (const glm::uvec3& t : mesh.triangles)
      triangles.push_back({mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z], o | flag});
  }
  return triangles;
}

}  // namespace

TriangleTree::TriangleTree(gpu::Context& context, const Scene& scene) {
  std::vector<TreeTriangle> triangles = all_triangles(scene);
  const std::size_t count = triangles.size();
  const std::size_t leaves =
      std::bit_ceil(std::max<std::size_t>((count + most_leaf_triangles - 1) / most_leaf_triangles, 1));
  const std::size_t each = std::max<std::size_t>((count + leaves - 1) / leaves, 1);
  halve(triangles, leaves);

  // Leaves have `each` places; what is left over is a triangle without area that no ray meets.
  std::vector<TreeTriangle> placed(leaves * each, TreeTriangle{});
  std::vector<TreeBox> boxes(2 * leaves, TreeBox{glm::vec3(1e30f), glm::vec3(-1e30f)});
  const auto place = [&](const auto& self, std::size_t node, std::size_t first, std::size_t n) -> void {
    TreeBox& box = boxes[node];
    if (node < leaves) {
      self(self, 2 * node, first, n / 2);
      self(self, 2 * node + 1, first + n / 2, n - n / 2);
      box = {glm::min(boxes[2 * node].low, boxes[2 * node + 1].low),
             glm::max(boxes[2 * node].high, boxes[2 * node + 1].high)};
      return;
    }
    for (std::size_t i = 0; i < n; ++i) {
      const TreeTriangle& t = placed[(node - leaves) * each + i] = triangles[first + i];
      box.low = glm::min(box.low, glm::min(t.a, glm::min(t.b, t.c)));
      box.high = glm::max(box.high, glm::max(t.a, glm::max(t.b, t.c)));
    }
  };
  place(place, 1, 0, count);
  leaves_ = static_cast<std::uint32_t>(leaves);
  leaf_triangles_ = static_cast<std::uint32_t>(each);
  boxes_ = gpu::make_buffer(context, boxes, "tree boxes");
  triangles_ = gpu::make_buffer(context, placed, "tree triangles");
}

}  // namespace alabaster
