// How hard a V-cycle works. Where a medium jumps from cell to cell, pieces of veins that lie within one coarse cell are
// no coarse grid's: there the smoother has to reach further down the spectrum.
#pragma once

namespace alabaster {

struct Smoothing {
  int sweeps;     // Chebyshev smoothing steps before and after the coarse correction
  double lowest;  // they damp the part [lowest, 1] of the l1-scaled spectrum
};

struct CycleOptions {
  Smoothing even{2, 0.15}, rough{3, 0.08};  // is_rough in islands.h decides
  int direct_cells = 512;                   // the first coarse level of at most this many cells is solved directly
};

}  // namespace alabaster
