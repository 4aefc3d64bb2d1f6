#include "scene/mesh_check.h"

#include "scene/error.h"
#include "scene/shapes.h"

namespace alabaster {

Mesh checked_solid(Mesh mesh, const std::string& name, const std::string& file, std::vector<std::string>& warnings) {
  double total = area(mesh);
  if (!(total > 0)) throw UserError(file + ": mesh '" + name + "' has no area; give it triangles of some size");
  if (glm::length(area_vector(mesh)) > 1e-5 * total)
    throw UserError(file + ": mesh '" + name + "' is not closed; a translucent object needs a closed surface");
  if (signed_volume(mesh) < 0) {
    warnings.push_back("'" + name + "' is inside out; its triangles were turned");
    mesh = flipped(std::move(mesh));
  }
  return mesh;
}

}  // namespace alabaster
