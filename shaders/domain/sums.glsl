// Sums over the pieces of surface in a cell, kept as integers so that the order of the additions does not matter: twin of
// Sums in engine/domain/cut_cells.cpp. Six classes a cell (2 * axis nearest to the normal + 1 where it points down it).
#include "shared/domain.h"

const float fixed_one = 16777216.0;  // 2^24: a sum holds up to 128 h^2
const int sum_A = 0;   // 3: integral n_i dA
const int sum_S = 3;   // integral dA
const int sum_X = 4;   // 3: integral x_i dA
const int sum_M = 7;   // 9: integral n_i x_j dA
const int sum_Q = 16;  // 3: integral n_i x_i^2 / 2 dA
const int sum_count = 19;

const float face_snap = 1e-5;     // h^2: apertures nearer than this to 0 or 1 are 0 or 1
const float least_volume = 1e-6;  // h^3: of a cell that holds surface
const float least_facet = 1e-7;   // h^2: smaller facets are dropped
const float least_sheet = 2e-4;   // h^2: smaller sheets make no slit

uint cell_index(ivec3 cell, ivec3 cells) { return uint(cell.x + cells.x * (cell.y + cells.y * cell.z)); }
ivec3 cell_at(uint index, ivec3 cells) {
  int i = int(index);
  return ivec3(i % cells.x, i / cells.x % cells.y, i / (cells.x * cells.y));
}

// Place of a cell among those whose bit is set, given its word and the number of bits set in the words before it.
uint rank_of(uint word, uint before, uint bit) { return before + bitCount(word & ((1u << bit) - 1u)); }
