// Where the shadow maps look. Every map is fitted to the translucent objects and to what stands near them; large
// surroundings (the ground, walls) are drawn into it and cast shadows on them, but do not stretch it.
#pragma once

#include <vector>

#include "lighting/lights.h"
#include "shared/lighting.h"

namespace alabaster {

/// What maps are fitted to: a sphere, and inside it the points that count (none: the sphere itself).
struct Focus {
  glm::dvec3 centre{0};           // m
  double radius = 0;              // m
  std::vector<glm::vec3> points;  // m
};

/// The translucent objects (all objects where there is none), grown by any other object that is no
/// light as long as that at most doubles the radius.
Focus shadow_focus(const Scene& scene);

/// Maps of one sample, not a directional one: one that looks at `focus` (a narrow spot's: along its axis), or, where
/// the sample lies so near that this would be wider than 120 degrees, the five or six faces of a cube around it. None
/// where all of `focus` is behind a one-sided light. `nearest` is the distance of the nearest caster, m: nothing in
/// front of the near plane casts.
std::vector<ShadowView> point_views(const LightSample& sample, const Focus& focus, double nearest, int map_size);

/// Orthographic map of light that comes from direction `from`; `scene` bounds all casters.
ShadowView direction_view(glm::vec3 from, const Focus& focus, const Bounds& scene, int map_size);

}  // namespace alabaster
