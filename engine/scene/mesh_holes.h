#pragma once

#include <vector>

#include "scene/scene.h"

namespace alabaster {

/// A closed line of edges that have a triangle on one side only.
struct Hole {
  std::vector<unsigned> vertices;  // in the order in which a patch's triangles run along it
  glm::vec3 centre{0};             // m
  double patch_area = 0;           // m^2, of the fan around the centre
};

/// The holes of a consistently wound mesh.
std::vector<Hole> find_holes(const Mesh& mesh);

/// Closes a hole by a fan around its centre (a triangle by itself). Other holes of the same mesh stay valid.
void fill(Mesh& mesh, const Hole& hole);

}  // namespace alabaster
