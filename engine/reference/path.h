// What is known of a light path under way.
#pragma once

#include <glm/glm.hpp>

#include "reference/paths.h"
#include "reference/world.h"

namespace alabaster {

struct Path {
  glm::vec3 origin{0}, direction{0};
  glm::vec3 throughput{1};  // per channel, over the density of the path as sampled by the channel `hero`
  glm::vec3 densities{1};   // density of the path, had each channel been the one that sampled it, over that of `hero`
  int hero = 0;
  Inside inside;
  bool on_surface = false;  // the origin lies on a surface
  Leaving leaving;
  // How the last vertex looked for the lights, for the balance heuristic: not at all (or a surface came since that
  // bends light), straight, or by a guide through such surfaces.
  enum class Sight { none, straight, guided } sight = Sight::none;
  Inside vertex_inside;
  glm::vec3 vertex{0}, vertex_direction{0};
  float direction_density = 0;  // 1/sr
  // Ball that holds no surface.
  glm::vec3 ball_centre{0};
  float ball_radius = 0;
  // For the layers.
  int scatterings = 0, entries = 0;
  bool scattered = false;  // in a medium or by an opaque surface
  bool met_surface = false, first_translucent = false, mirrored_first = false;

  glm::vec3 weight() const { return throughput * (3.0f / (densities.x + densities.y + densities.z)); }
  Layer layer() const {
    if (!first_translucent || entries == 0) return Layer::surface;
    return mirrored_first || entries > 1 || scatterings > 1 ? Layer::multiple : Layer::single;
  }
};

}  // namespace alabaster
