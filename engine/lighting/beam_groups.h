// Which light samples go through an object as one beam.
#pragma once

#include <vector>

#include "domain/grid_frame.h"
#include "lighting/lights.h"

namespace alabaster {

/// Sizes of groups of samples that follow each other in LightSamples::area and add up to all of them. Seen from
/// anywhere in the frame's box a group lies within some 8 degrees of its middle (refraction makes less of that inside):
/// one beam with the light of all, along its mean direction, is laid down as theirs would be.
std::vector<std::uint32_t> beam_groups(const LightSamples& lights, const GridFrame& frame);

}  // namespace alabaster
