// The table of embedded shaders that shaders/shaders.cmake writes.
#pragma once

#include <cstddef>
#include <cstdint>

namespace alabaster::gpu {

struct SpirvEntry {
  const char* name;  // path below shaders/, e.g. "diffusion/residual.comp"; a null name ends the table
  const std::uint32_t* words;
  std::size_t count;  // words
};

extern const SpirvEntry spirv_table[];

}  // namespace alabaster::gpu
