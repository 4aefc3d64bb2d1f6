// How hard a V-cycle works. Where a medium jumps from cell to cell, pieces of veins that lie within one coarse cell are
// no coarse grid's: the smoother has to reach further down the spectrum, and a second visit of the first coarse level
// saves two or three iterations more than it costs.
#pragma once

namespace alabaster {

struct Smoothing {
  int sweeps;     // Chebyshev smoothing steps before and after the coarse correction
  double lowest;  // they damp the part [lowest, 1] of the l1-scaled spectrum
  int visits;     // of the first coarse level in a cycle: 1, or 2 that make a Chebyshev iteration of two steps
};

struct CycleOptions {
  Smoothing even{2, 0.15, 1}, rough{4, 0.05, 2};  // Islands::rough decides
  double visited = 0.3;    // two visits damp the part [visited, 1] of the preconditioned spectrum
  int direct_cells = 512;  // the first coarse level of at most this many cells is solved directly
};

}  // namespace alabaster
