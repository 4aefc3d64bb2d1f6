// Where beams start: places of the mesh in each cut cell, with its own normals. One start a facet would blunt every
// edge and crease that a cell holds: of a ridge with one side lit, what enters is less by the facet's mean normal than
// it is by the mesh's.
#pragma once

#include <vector>

#include "domain/domain.h"
#include "shared/beam.h"

namespace alabaster {

struct BeamStarts {
  std::vector<BeamStart> starts;  // those of an entry one after the other
  std::vector<glm::uvec2> of;  // first and count, two an entry of Domain::cut_cells; their areas add up to the facet's
  std::uint32_t most = 0;      // of a facet
};

/// The triangles' parts in each facet, put together where their normals are alike, in BEAM_MOST_STARTS places at most.
/// A facet that has none of them is its own start.
BeamStarts mesh_starts(const Mesh& mesh, const GridFrame& frame, const std::vector<GpuCutCell>& cut_cells);

/// One start a facet: its middle.
BeamStarts facet_starts(const GridFrame& frame, const std::vector<GpuCutCell>& cut_cells);

}  // namespace alabaster
