// A translucent object on a solver grid: cut cells made on the device from its closed mesh.
// The definitions of volume, aperture, facet and the treatment of thin parts stand in cut_cells.h, the twin.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "domain/grid_frame.h"
#include "gpu/commands.h"
#include "scene/scene.h"
#include "shared/domain.h"

namespace alabaster {

struct DomainSummary {
  std::uint32_t cut_cells = 0;    // with surface
  std::uint32_t inner_cells = 0;  // whole
  std::uint32_t slit_cells = 0;  // whose pieces beyond a gap were given to neighbours
  double volume = 0;             // m^3
  double area = 0;               // m^2
  glm::dvec3 area_vector{0};     // m^2, 0 for a closed mesh but for rounding
  double worst_closure = 0;      // h^2, largest aperture left at the far end of a row of cells
};

/// Dense fields hold four x-neighbours a texel: size (cells.x / 4, cells.y, cells.z), rgba32f.
struct Domain {
  GridFrame frame;
  gpu::Image volume;           // h^3: 0 outside, 1 inside, else the cut cell's (above 1 for takers of a gift)
  gpu::Image aperture[3];      // h^2: open part of the face between a cell and its lower x, y, z neighbour
  gpu::Image cut_index;        // r32ui, size `cells`: index into cut_cells, 0 for cells without surface
  gpu::Buffer cut_cells;       // GpuCutCell[summary.cut_cells + 1]; entry 0 is a plain inner cell
  DomainSummary summary;
  std::vector<std::string> warnings;
};

/// Makes domains; holds the pipelines, so that a second domain costs no set-up.
class DomainMaker {
 public:
  explicit DomainMaker(gpu::Context& context);

  /// Cuts the grid with the closed mesh, on the device. Sums are integers of 2^-24 h^2, so the result does not depend
  /// on the order of the additions; a cell may hold up to 100 h^2 of surface. Throws UserError where the mesh is not
  /// closed, is inside out but for a few folds, or is too crumpled or too finely gridded for the device.
  Domain make(const Mesh& mesh, const GridFrame& frame) const;

 private:
  friend class DomainBuild;
  gpu::Context& context_;
  gpu::Pass mark_, scan_, list_, pair_, accumulate_, candidate_, sweep_x_, sweep_y_, sweep_z_, finish_, finish_parted_,
      part_, dense_, totals_;
};

/// One domain, for callers that make no second.
Domain make_domain(gpu::Context& context, const Mesh& mesh, const GridFrame& frame);

}  // namespace alabaster
