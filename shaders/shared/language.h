// The few words that let one header be GLSL and C++ at once.
// In C++ a shared function is a template over its real type, so the tests can call the shader's own source in double
// precision; in GLSL `real` is float. One with vectors is SHARED_INLINE and float in both. Shared structs use `scalar`
// block layout (GL_EXT_scalar_block_layout).
#ifndef ALABASTER_SHARED_LANGUAGE_H
#define ALABASTER_SHARED_LANGUAGE_H

#ifdef __cplusplus
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

#define ALABASTER_BEGIN_SHARED namespace alabaster {
#define ALABASTER_END_SHARED }
#define SHARED_FN template <typename real> inline
#define SHARED_INLINE inline

namespace alabaster {
using glm::ivec2, glm::ivec3, glm::ivec4, glm::mat4, glm::uvec2, glm::uvec3, glm::uvec4, glm::vec2, glm::vec3, glm::vec4;
using uint = std::uint32_t;
using std::abs, std::cos, std::exp, std::log, std::max, std::min, std::sin, std::sqrt;
}  // namespace alabaster
#else
#define ALABASTER_BEGIN_SHARED
#define ALABASTER_END_SHARED
#define SHARED_FN
#define SHARED_INLINE
#define real float
#endif

#endif
