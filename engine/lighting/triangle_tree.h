// A tree of boxes over all triangles of a scene, for rays on the device (shaders/lighting/tree.glsl).
#pragma once

#include "gpu/pass.h"
#include "scene/scene.h"

namespace alabaster {

/// Complete and binary: each node's triangles are halved at the median along the longest side of their middles' bounds,
/// so that there are no pointers and the walk needs no stack.
class TriangleTree {
 public:
  /// Builds it on the host and uploads it.
  TriangleTree(gpu::Context& context, const Scene& scene);

  /// What a shader that includes lighting/tree.glsl needs; and it must push leaves() and leaf_triangles().
  gpu::Bindings bindings() const { return {{"boxes", boxes_}, {"tree_triangles", triangles_}}; }
  const gpu::Buffer& triangles() const { return triangles_; }  // TreeTriangle, leaf by leaf
  std::uint32_t leaves() const { return leaves_; }
  std::uint32_t leaf_triangles() const { return leaf_triangles_; }

 private:
  std::uint32_t leaves_ = 1, leaf_triangles_ = 1;
  gpu::Buffer boxes_, triangles_;
};

}  // namespace alabaster
