// Which side of a closed surface a point is on, by counting crossings along rays.
#pragma once

#include <embree3/rtcore.h>

#include <memory>
#include <vector>

#include "scene/scene.h"

namespace alabaster {

/// Where a ray passes through a mesh.
struct Crossing {
  unsigned triangle;
  bool outwards;  // along the triangle's normal
};

/// Ray queries on one mesh, which it copies. Several threads may ask at once.
class MeshRays {
 public:
  explicit MeshRays(const Mesh& mesh);

  /// Every crossing of the ray from `origin`, in no order; an edge may count once for each of its triangles.
  std::vector<Crossing> crossings(glm::vec3 origin, glm::vec3 direction) const;

  /// Whether the surface winds around the point. Decided by most of five rays in general directions, so that one ray
  /// through an edge or a crack does no harm; a point on the surface may go either way.
  bool inside(glm::vec3 point) const;

 private:
  struct Release {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };
  std::unique_ptr<RTCSceneTy, Release> scene_;
};

/// MeshRays::inside() for a single point.
bool inside(const Mesh& mesh, glm::vec3 point);

/// Five directions that no modeller aligns faces or edges with.
extern const glm::vec3 general_directions[5];

}  // namespace alabaster
