#include "scene/depth.h"

#include <embree3/rtcore.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>
#include <unordered_map>

#include "scene/closest.h"
#include "scene/procedural.h"
#include "scene/shapes.h"

namespace alabaster {
namespace {

constexpr int points_along = 96;

/// Nearest points of a mesh, and on which side of it a point is.
class Surface {
 public:
  explicit Surface(const Mesh& mesh) : mesh_(mesh), corners_(mesh.positions.size(), glm::dvec3(0)) {
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) add_normals(t);
    device_.reset(rtcNewDevice(nullptr));
    scene_.reset(rtcNewScene(device_.get()));
    RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    void* positions = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3),
                                              mesh.positions.size());
    void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3),
                                              mesh.triangles.size());
    std::memcpy(positions, mesh.positions.data(), mesh.positions.size() * sizeof(glm::vec3));
    std::memcpy(triangles, mesh.triangles.data(), mesh.triangles.size() * sizeof(glm::uvec3));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_.get());
  }

  /// m below the surface; false where it is further than `reach` away.
  bool depth(glm::dvec3 p, double reach, double& depth) const {
    Search search{this, p, reach, {}, 0};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    RTCPointQuery query{float(p.x), float(p.y), float(p.z), 0, float(reach)};
    rtcPointQuery(scene_.get(), &query, &context, visit, &search);
    if (!(search.distance < reach)) return false;
    depth = glm::dot(p - search.closest.point, pseudonormal(search)) < 0 ? search.distance : -search.distance;
    return true;
  }

 private:
  struct Search {
    const Surface* surface;
    glm::dvec3 point;
    double distance;
    Closest closest;
    unsigned triangle;
  };
  struct Release {
    void operator()(RTCDeviceTy* device) const { rtcReleaseDevice(device); }
    void operator()(RTCSceneTy* scene) const { rtcReleaseScene(scene); }
  };

  static bool visit(RTCPointQueryFunctionArguments* call) {
    auto& search = *static_cast<Search*>(call->userPtr);
    const Mesh& mesh = search.surface->mesh_;
    const glm::uvec3 t = mesh.triangles[call->primID];
    const Closest closest =
        closest_on_triangle(search.point, mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]);
    const double distance = glm::distance(search.point, closest.point);
    if (distance >= search.distance) return false;
    search.distance = distance, search.closest = closest, search.triangle = call->primID;
    call->query->radius = float(distance) * 1.0001f;
    return true;
  }

  static std::uint64_t edge_key(unsigned a, unsigned b) { return std::uint64_t(std::min(a, b)) << 32 | std::max(a, b); }

  glm::dvec3 unit_normal(glm::uvec3 t) const {
    const glm::dvec3 a = mesh_.positions[t.x], b = mesh_.positions[t.y], c = mesh_.positions[t.z];
    const glm::dvec3 n = glm::cross(b - a, c - a);
    return n / std::max(glm::length(n), 1e-300);
  }

  void add_normals(std::uint32_t triangle) {
    const glm::uvec3 t = mesh_.triangles[triangle];
    const glm::dvec3 normal = unit_normal(t);
    for (int i = 0; i < 3; ++i) {
      const unsigned here = t[i], next = t[(i + 1) % 3], last = t[(i + 2) % 3];
      edges_[edge_key(here, next)] += normal;
      const glm::dvec3 p = mesh_.positions[here], u = glm::dvec3(mesh_.positions[next]) - p,
                       v = glm::dvec3(mesh_.positions[last]) - p;
      corners_[here] += std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v)) * normal;
    }
  }

  glm::dvec3 pseudonormal(const Search& search) const {
    const glm::uvec3 t = mesh_.triangles[search.triangle];
    int on[3], count = 0;
    for (int i = 0; i < 3; ++i)
      if (search.closest.weights[i] > 0) on[count++] = i;
    if (count == 1) return corners_[t[on[0]]];
    if (count == 2) return edges_.at(edge_key(t[on[0]], t[on[1]]));
    return unit_normal(t);
  }

  const Mesh& mesh_;
  std::unordered_map<std::uint64_t, glm::dvec3> edges_;
  std::vector<glm::dvec3> corners_;
  std::unique_ptr<RTCDeviceTy, Release> device_;
  std::unique_ptr<RTCSceneTy, Release> scene_;
};

}  // namespace

DepthGrid measure_depth(const Mesh& mesh, double deepest) {
  const Bounds bounds = bounds_of(mesh);
  const glm::dvec3 extent = bounds.size();
  const double step = std::max({extent.x, extent.y, extent.z}) / points_along;
  const double reach = std::max(deepest, 2 * step) + 2 * step;
  auto grid = std::make_shared<Grid>();
  grid->size = glm::ivec3(glm::ceil(extent / step)) + 4;  // two points beyond the surface on each side
  const glm::dvec3 low = glm::dvec3(bounds.low) - 2 * step, size = step * glm::dvec3(grid->size);
  grid->values.resize(std::size_t(grid->size.x) * std::size_t(grid->size.y) * std::size_t(grid->size.z));
  const Surface surface(mesh);
  tbb::parallel_for(0, grid->size.z, [&](int z) {
    for (int y = 0; y < grid->size.y; ++y) {
      // Rows begin outside; what is too far away is on the side of the point before it, from which no distance differs
      // by more than a step.
      double depth = -reach;
      for (int x = 0; x < grid->size.x; ++x) {
        const double radius = std::min(reach, 1.001 * (std::abs(depth) + step));
        if (!surface.depth(low + step * (glm::dvec3(x, y, z) + 0.5), radius, depth)) depth = depth < 0 ? -reach : reach;
        grid->values[x + std::size_t(grid->size.x) * (y + std::size_t(grid->size.y) * z)] = float(depth);
      }
    }
  });
  return {grid, glm::inverse(translation(low) * scaling(size))};
}

void add_depth(Object& object) {
  Medium& medium = object.medium;
  if (!medium.solid || medium.solid->kind != solid_skin) return;
  const DepthGrid depth = measure_depth(object.mesh, (1 + 0.25 / medium.solid->sharpness) * medium.solid->depths.y);
  medium.depth = depth.grid;
  medium.world_to_depth = depth.world_to_box;
}

}  // namespace alabaster
