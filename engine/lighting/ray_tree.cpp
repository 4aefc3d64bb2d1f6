#include "lighting/ray_tree.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <memory>
#include <new>
#include <stdexcept>
#include <type_traits>

namespace alabaster {

static_assert(sizeof(RayNode) == 32 && sizeof(RayTriangle) == 48 && sizeof(RayHit) == 8);

namespace {

constexpr unsigned most_in_leaf = 4;
constexpr float step_cost = 1.2f;  // of an inner node (two boxes), in units of a triangle

template <auto release>
struct Released {
  template <class T>
  void operator()(T* t) const {
    release(t);
  }
};
using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, Released<rtcReleaseDevice>>;
using Bvh = std::unique_ptr<std::remove_pointer_t<RTCBVH>, Released<rtcReleaseBVH>>;

/// What Embree's builder makes of the triangles before they are put in depth-first order.
struct BuildNode {
  RTCBounds bounds[2];  // of the children, which are set later
  BuildNode* children[2];
  unsigned count;  // triangles of a leaf; 0: inner
  unsigned triangles[most_in_leaf];
};

void* make_node(RTCThreadLocalAllocator allocator, unsigned, void*) {
  return new (rtcThreadLocalAlloc(allocator, sizeof(BuildNode), alignof(BuildNode))) BuildNode{};
}

void set_children(void* node, void** children, unsigned count, void*) {
  for (unsigned i = 0; i < count; ++i)
    static_cast<BuildNode*>(node)->children[i] = static_cast<BuildNode*>(children[i]);
}

void set_bounds(void* node, const RTCBounds** bounds, unsigned count, void*) {
  for (unsigned i = 0; i < count; ++i) static_cast<BuildNode*>(node)->bounds[i] = *bounds[i];
}

void* make_leaf(RTCThreadLocalAllocator allocator, const RTCBuildPrimitive* primitives, std::size_t count, void*) {
  auto* leaf = static_cast<BuildNode*>(make_node(allocator, 0, nullptr));
  leaf->count = static_cast<unsigned>(count);
  for (std::size_t i = 0; i < count; ++i) leaf->triangles[i] = primitives[i].primID;
  std::sort(leaf->triangles, leaf->triangles + count);  // threads may hand them over in any order
  return leaf;
}

/// All triangles of a scene, and a box around each for the builder.
struct Primitives {
  explicit Primitives(const Scene& scene) {
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
      const Object& object = scene.objects[i];
      for (const glm::uvec3& t : object.mesh.triangles) {
        const glm::vec3 a = object.mesh.positions[t.x], b = object.mesh.positions[t.y], c = object.mesh.positions[t.z];
        const glm::vec3 low = glm::min(glm::min(a, b), c), high = glm::max(glm::max(a, b), c);
        const auto id = static_cast<unsigned>(triangles.size());
        triangles.push_back({a, b - a, c - a, static_cast<uint>(i), object.role == Role::translucent, 0});
        boxes.push_back({low.x, low.y, low.z, 0, high.x, high.y, high.z, id});
      }
    }
  }
  std::vector<RayTriangle> triangles;
  std::vector<RTCBuildPrimitive> boxes;
};

void add_nodes(const BuildNode& node, const RTCBounds& box, const Primitives& primitives, RayTree& tree) {
  const std::size_t at = tree.nodes.size();
  tree.nodes.push_back({{box.lower_x, box.lower_y, box.lower_z},
                        static_cast<uint>(tree.triangles.size()),
                        {box.upper_x, box.upper_y, box.upper_z},
                        node.count});
  for (unsigned i = 0; i < node.count; ++i) tree.triangles.push_back(primitives.triangles[node.triangles[i]]);
  if (node.count) return;
  for (int i = 0; i < 2; ++i) add_nodes(*node.children[i], node.bounds[i], primitives, tree);
  tree.nodes[at].link = static_cast<uint>(tree.nodes.size());
}

RTCBounds bounds_of(const std::vector<RTCBuildPrimitive>& boxes) {
  Bounds all;
  for (const RTCBuildPrimitive& box : boxes) {
    all.add({box.lower_x, box.lower_y, box.lower_z});
    all.add({box.upper_x, box.upper_y, box.upper_z});
  }
  return {all.low.x, all.low.y, all.low.z, 0, all.high.x, all.high.y, all.high.z, 0};
}

bool meets(const RayNode& box, glm::vec3 origin, glm::vec3 inverse, float near, float far) {
  const glm::vec3 a = (box.low - origin) * inverse, b = (box.high - origin) * inverse;
  const glm::vec3 in = glm::min(a, b), out = glm::max(a, b);
  return std::max({in.x, in.y, in.z, near}) <= std::min({out.x, out.y, out.z, far}) * ray_box_slack;
}

}  // namespace

RayTree make_ray_tree(const Scene& scene) {
  Primitives primitives(scene);
  RayTree tree;
  if (primitives.boxes.empty()) return tree;
  const Device device(rtcNewDevice(nullptr));
  const Bvh bvh(device ? rtcNewBVH(device.get()) : nullptr);
  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.maxLeafSize = most_in_leaf;
  arguments.maxDepth = 1024;
  arguments.traversalCost = step_cost;
  arguments.bvh = bvh.get();
  arguments.primitives = primitives.boxes.data();
  arguments.primitiveCount = arguments.primitiveArrayCapacity = primitives.boxes.size();
  arguments.createNode = make_node;
  arguments.setNodeChildren = set_children;
  arguments.setNodeBounds = set_bounds;
  arguments.createLeaf = make_leaf;
  const RTCBounds whole = bounds_of(primitives.boxes);  // the builder sorts the boxes
  const auto* root = bvh ? static_cast<const BuildNode*>(rtcBuildBVH(&arguments)) : nullptr;
  if (!root) throw std::runtime_error("ray tree: Embree could not build it");
  tree.triangles.reserve(primitives.triangles.size());
  add_nodes(*root, whole, primitives, tree);
  return tree;
}

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
