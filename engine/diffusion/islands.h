// Islands: pieces of a medium that conduct well within and hardly at all to what lies around them. Whatever an island's
// constant is, it is nearly a solution, and where the island lies badly against the coarse grids neither the smoother
// nor the coarse grids move it: one small eigenvalue an island, which costs conjugate gradients an iteration or two
// each. So they are deflated: one unknown an island, solved exactly (Nicolaides 1987; Vuik, Segal, Meijerink 1999).
//   Z: column = 1 on an island's cells, 0 elsewhere; E = Z^T A Z, diagonal because no two islands touch.
//   start x += Z E^-1 Z^T (b - A x); then in every iteration z += Z E^-1 Z^T (r - A z).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "shared/diffusion.h"

namespace alabaster {

/// An island's place in the list of entries: its cells, then its faces.
struct IslandSpan {
  std::uint32_t cells, faces, end;
  float weight;  // 1 / E of the island
};

/// The islands of one channel's finest stencil.
struct Islands {
  std::vector<std::uint32_t> labels;   // of every cell, x fastest: 0, or 1 + its island's number
  std::vector<IslandSpan> spans;       // of each island in `entries`; spans.size() of them
  std::vector<std::uint32_t> entries;  // packed cells and faces: DIFFUSION_ISLAND_CELL in shared/diffusion.h
};

/// How rough a channel's medium is; the twin of rough.comp. `stencil` as below.
Roughness roughness(glm::ivec3 n, std::span<const float> stencil);

/// The medium jumps from cell to cell in many places: it wants more smoothing (smoothing.h).
bool is_rough(const Roughness& r);

/// Share of the cells within that lie between faces of three magnitudes: noise at cell scale.
double noise_share(const Roughness& r);

/// Only a medium's jumps make islands; where few cells have six faces, what is cut off by the surface does, too.
bool may_have_islands(const Roughness& r);

/// `stencil`: rows of DIFFUSION_FINEST_ENTRIES * n.x values, as the device holds one channel; n.x a multiple of 4.
/// Grids of more than DIFFUSION_ISLAND_CELLS cells along an axis have none.
Islands find_islands(glm::ivec3 n, std::span<const float> stencil);

}  // namespace alabaster
