#include "lighting/ray_tree.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <numeric>

namespace alabaster {

static_assert(sizeof(RayNode) == 32 && sizeof(RayTriangle) == 48 && sizeof(RayHit) == 8);

namespace {

constexpr int bins = 16;
constexpr std::uint32_t most_in_leaf = 4;
constexpr std::uint32_t least_apart = 4096;  // triangles of a node whose children are built side by side
constexpr float step_cost = 0.6f;            // of a box, in units of a triangle

float half_area(const Bounds& box) {
  const glm::vec3 e = box.size();
  return e.x < 0 ? 0 : e.x * e.y + e.y * e.z + e.z * e.x;
}

void add(Bounds& box, const Bounds& other) {
  box.low = glm::min(box.low, other.low);
  box.high = glm::max(box.high, other.high);
}

struct Split {
  float cost = INFINITY;
  int axis = -1, bin = 0;
};

class Builder {
 public:
  explicit Builder(const Scene& scene) {
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
      const Object& object = scene.objects[i];
      for (const glm::uvec3& t : object.mesh.triangles) {
        const glm::vec3 a = object.mesh.positions[t.x], b = object.mesh.positions[t.y], c = object.mesh.positions[t.z];
        triangles_.push_back({a, b - a, c - a, static_cast<uint>(i), object.role == Role::translucent, 0});
        Bounds& box = boxes_.emplace_back();
        box.add(a), box.add(b), box.add(c);
      }
    }
    order_.resize(triangles_.size());
    std::iota(order_.begin(), order_.end(), 0u);
  }

  RayTree build() {
    RayTree tree;
    if (!triangles_.empty()) add_nodes(0, static_cast<std::uint32_t>(order_.size()), tree.nodes);
    tree.triangles.reserve(order_.size());
    for (std::uint32_t i : order_) tree.triangles.push_back(triangles_[i]);
    return tree;
  }

 private:
  int bin_of(std::uint32_t triangle, const Bounds& centres, int axis) const {
    const float share = (boxes_[triangle].centre()[axis] - centres.low[axis]) / centres.size()[axis];
    return std::clamp(static_cast<int>(share * bins), 0, bins - 1);
  }

  Split best_split(std::uint32_t first, std::uint32_t end, const Bounds& centres) const {
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(centres.size()[axis] > 0)) continue;
      Bounds box[bins];
      int number[bins] = {};
      for (std::uint32_t i = first; i < end; ++i) {
        const int bin = bin_of(order_[i], centres, axis);
        add(box[bin], boxes_[order_[i]]);
        ++number[bin];
      }
      float above[bins];  // cost of what lies in the bins from this one on
      Bounds sum;
      int count = 0;
      for (int bin = bins - 1; bin > 0; --bin) {
        add(sum, box[bin]), count += number[bin];
        above[bin] = half_area(sum) * static_cast<float>(count);
      }
      sum = {}, count = 0;
      for (int bin = 1; bin < bins; ++bin) {
        add(sum, box[bin - 1]), count += number[bin - 1];
        const float cost = half_area(sum) * static_cast<float>(count) + above[bin];
        if (cost < best.cost) best = {cost, axis, bin};
      }
    }
    return best;
  }

  /// Where the second child starts; `end` for a leaf.
  std::uint32_t part(std::uint32_t first, std::uint32_t end, const Bounds& box, const Bounds& centres) {
    const std::uint32_t count = end - first;
    const Split split = best_split(first, end, centres);
    const float whole = half_area(box);
    if (count <= most_in_leaf && !(split.cost + 2 * step_cost * whole < static_cast<float>(count) * whole)) return end;
    if (split.axis < 0) return count <= most_in_leaf ? end : first + count / 2;  // all centres in one place
    const auto middle = std::partition(order_.begin() + first, order_.begin() + end,
                                       [&](std::uint32_t i) { return bin_of(i, centres, split.axis) < split.bin; });
    return static_cast<std::uint32_t>(middle - order_.begin());
  }

  void add_nodes(std::uint32_t first, std::uint32_t end, std::vector<RayNode>& nodes) {
    Bounds box, centres;
    for (std::uint32_t i = first; i < end; ++i) add(box, boxes_[order_[i]]), centres.add(boxes_[order_[i]].centre());
    const std::uint32_t middle = part(first, end, box, centres);
    const std::size_t at = nodes.size();
    nodes.push_back({box.low, first, box.high, middle == end ? end - first : 0});
    if (middle == end) return;
    if (end - first < least_apart) {
      add_nodes(first, middle, nodes);
      add_nodes(middle, end, nodes);
    } else {
      std::vector<RayNode> below[2];
      tbb::parallel_invoke([&] { add_nodes(first, middle, below[0]); }, [&] { add_nodes(middle, end, below[1]); });
      for (const std::vector<RayNode>& child : below) append(child, nodes);
    }
    nodes[at].link = static_cast<uint>(nodes.size());
  }

  static void append(const std::vector<RayNode>& child, std::vector<RayNode>& nodes) {
    const auto before = static_cast<std::uint32_t>(nodes.size());
    for (RayNode node : child) {
      if (node.count == 0) node.link += before;
      nodes.push_back(node);
    }
  }

  std::vector<RayTriangle> triangles_;
  std::vector<Bounds> boxes_;
  std::vector<std::uint32_t> order_;
};

bool meets(const RayNode& box, glm::vec3 origin, glm::vec3 inverse, float near, float far) {
  const glm::vec3 a = (box.low - origin) * inverse, b = (box.high - origin) * inverse;
  const glm::vec3 in = glm::min(a, b), out = glm::max(a, b);
  return std::max({in.x, in.y, in.z, near}) <= std::min({out.x, out.y, out.z, far}) * ray_box_slack;
}

}  // namespace

RayTree make_ray_tree(const Scene& scene) { return Builder(scene).build(); }

RayHit trace(const RayTree& tree, glm::vec3 origin, glm::vec3 direction, float near, float far) {
  const glm::vec3 inverse(ray_inverse(direction.x), ray_inverse(direction.y), ray_inverse(direction.z));
  RayHit hit{far, ray_missed};
  for (std::uint32_t at = 0; at < tree.nodes.size();) {
    const RayNode& node = tree.nodes[at];
    if (!meets(node, origin, inverse, near, hit.distance)) {
      at = node.count ? at + 1 : node.link;
      continue;
    }
    for (std::uint32_t i = 0; i < node.count; ++i) {
      const RayTriangle& t = tree.triangles[node.link + i];
      const glm::vec3 p = glm::cross(direction, t.edge2), from = origin - t.corner, q = glm::cross(from, t.edge1);
      const float det = glm::dot(t.edge1, p);
      if (t.closed ? det <= 0 : det == 0) continue;
      const float u = glm::dot(from, p) / det, v = glm::dot(direction, q) / det, s = glm::dot(t.edge2, q) / det;
      if (std::min({u, v, 1 - u - v}) >= -ray_edge_slack && s >= near && s < hit.distance) hit = {s, node.link + i};
    }
    ++at;
  }
  return hit;
}

namespace {

/// An image of rows of 2^ray_row_bits items.
template <class Item>
gpu::Image item_image(gpu::Context& context, std::vector<Item> items, uint texels, const char* name) {
  static_assert(sizeof(Item) % sizeof(glm::uvec4) == 0);
  constexpr std::size_t in_row = std::size_t(1) << ray_row_bits;
  const std::size_t rows = std::max<std::size_t>((items.size() + in_row - 1) / in_row, 1);
  items.resize(rows * in_row, Item{});
  gpu::ImageSpec spec;
  spec.size = {texels << ray_row_bits, rows, 1};
  spec.format = VK_FORMAT_R32G32B32A32_UINT;
  spec.type = VK_IMAGE_TYPE_2D;
  gpu::Image image(context, spec, name);
  gpu::upload(context, image, items);
  return image;
}

}  // namespace

DeviceRayTree upload_ray_tree(gpu::Context& context, const RayTree& tree) {
  return {item_image(context, tree.nodes, ray_node_texels, "ray tree"),
          item_image(context, tree.triangles, ray_triangle_texels, "ray triangles")};
}

}  // namespace alabaster
