// How bright the gather is, place by place.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "shared/gather.h"

namespace alabaster {

/// Light that leaves by a place of the surface.
struct GatherPlace {
  glm::vec3 position, normal;  // h, from the grid's corner; unit
  GatherFlux flux;
};

/// Flux that the diffusion equation sends out over the flux that the gather does at level 1, around each place and for
/// each of the six ways that a surface can look. Out of plates of any thickness the diffusion equation sends nearly the
/// flux that transport does, while the gather's level falls short as they get thin (gather_closure.h holds for half
/// spaces); but within a few mean free paths the gather knows better where light leaves, so sums over those are
/// compared. The sum over all places is the diffusion equation's: energy is kept.
class GatherLevels {
 public:
  /// `cells` of the grid; `edge` in cells (h), the distance of the nodes.
  GatherLevels(glm::ivec3 cells, float edge, const std::vector<GatherPlace>& places);

  /// At a place of the surface, as shading/gathered.comp has it.
  glm::dvec3 at(glm::dvec3 position, glm::dvec3 normal) const;

  /// Along each axis.
  glm::ivec3 nodes() const { return nodes_; }
  /// Six blocks of nodes along z: normals up x, down x, up y, ...; x fastest.
  const std::vector<glm::vec4>& texels() const { return texels_; }
  float edge() const { return edge_; }
  /// Of all places together.
  glm::dvec3 mean() const { return mean_; }

 private:
  glm::ivec3 nodes_;
  float edge_;
  glm::dvec3 mean_{1};
  std::vector<glm::vec4> texels_;
};

}  // namespace alabaster
