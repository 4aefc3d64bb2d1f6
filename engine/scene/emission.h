// Textured emission: a lamp is cut along the grid of its texels at load, so that all that follows knows one radiance an
// object.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace alabaster {

/// emissiveTexture, decoded to linear. Row 0 is at v = 0 (glTF: the top).
struct EmissionTexture {
  enum class Wrap { repeat, mirror, clamp };
  glm::ivec2 size{0};
  std::vector<glm::vec3> texels;  // 0 to 1, rows of size.x
  Wrap wrap[2] = {Wrap::repeat, Wrap::repeat};
  int set = 0;  // TEXCOORD_n

  bool empty() const { return texels.empty(); }
  /// Of the texel that covers [x, x + 1] x [y, y + 1] in texels, wrapped.
  glm::vec3 at(glm::ivec2 texel) const;
};

/// Halves a texture by means over 2x2 texels until it has no more than most_emission_texels: a lamp of a million
/// triangles says no more of what it lights than one of thousands, and means keep the power.
inline constexpr int most_emission_texels = 64 * 64;
EmissionTexture reduced(EmissionTexture texture);

/// The encoded bytes of a PNG or JPEG. `place` begins the UserError thrown where they cannot be decoded.
EmissionTexture decode_emission(const std::vector<unsigned char>& bytes, const std::string& place);

/// `lamp` in parts of one radiance each: the triangles cut along the texels (without filtering), texels put together in
/// no more than most_emission_parts parts by their radiance, each part's the mean over its area, so that the power is
/// kept. `texcoords` are in units of the texture, one a vertex. lamp.radiance is that of a white texel. Throws
/// UserError where a triangle spans more than most_emission_texels texels (of a texture repeated that often).
inline constexpr std::size_t most_emission_parts = 16;
std::vector<Object> cut_by_texels(const Object& lamp, const std::vector<glm::vec2>& texcoords,
                                  const EmissionTexture& texture, const std::string& place);

}  // namespace alabaster
