// What a render has to say about itself: --stats and the EXR's attributes.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "pipeline/render.h"

namespace alabaster {

/// `stages`, `passes` (milliseconds on the device, by pass or group of passes), `solver`, `energy`, `negative`, `plan`, and `objects` with the same for each object. Powers in W.
nlohmann::json stats_json(const RenderResult& result, const Plan& plan, const gpu::Context& context);

/// Puts every setting, the time of each stage, the solver's residual and the energy balance into the picture's
/// attributes.
void describe(const RenderResult& result, const Plan& plan, const gpu::Context& context, Picture& picture);

}  // namespace alabaster
