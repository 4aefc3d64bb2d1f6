// The facets of a cut-cell domain as places that light arrives at.
#pragma once

#include "domain/domain.h"
#include "gpu/commands.h"

namespace alabaster {

class FacetReceivers {
 public:
  FacetReceivers(gpu::Context& context, const Domain& domain);

  void record(gpu::Commands& commands) const;

  /// Receiver (shared/lighting.h), two an entry of Domain::cut_cells: one for each side of its surface.
  const gpu::Buffer& buffer() const { return receivers_; }
  std::uint32_t count() const { return 2 * cut_cells_; }

 private:
  const Domain& domain_;
  std::uint32_t cut_cells_;  // entry 0 included
  gpu::Pass pass_;
  gpu::Buffer receivers_;
};

}  // namespace alabaster
