// How paths find the lamps behind refracting surfaces.
#pragma once

namespace alabaster {

/// Whether paths inside refracting objects look for the lights through the surface (LightGuide), which costs several
/// rays each time, or meet them by chance, which is noisy where lights are small. Either is unbiased.
enum class Guiding { automatic, always, never };

}  // namespace alabaster
