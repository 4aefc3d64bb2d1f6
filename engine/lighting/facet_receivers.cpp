#include "lighting/facet_receivers.h"

#include "shared/lighting.h"

namespace alabaster {

FacetReceivers::FacetReceivers(gpu::Context& context, const Domain& domain)
    : domain_(domain),
      cut_cells_(domain.summary.cut_cells + 1),
      pass_(context, "lighting/facet_receivers.comp"),
      receivers_(context, count() * sizeof(Receiver), "facet receivers") {}

void FacetReceivers::record(gpu::Commands& commands) const {
  commands.dispatch(pass_, {count(), 1, 1}, {{"cut_cells", domain_.cut_cells}, {"receivers", receivers_}},
                    FacetPush{domain_.frame.origin, domain_.frame.h, cut_cells_});
}

}  // namespace alabaster
