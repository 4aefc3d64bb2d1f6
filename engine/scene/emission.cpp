#include "scene/emission.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "scene/error.h"

namespace alabaster {
namespace {

float from_srgb(unsigned char v) {
  const double c = v / 255.0;
  return static_cast<float>(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
}

int wrapped(int i, int size, EmissionTexture::Wrap wrap) {
  if (wrap == EmissionTexture::Wrap::clamp) return std::clamp(i, 0, size - 1);
  const int period = wrap == EmissionTexture::Wrap::mirror ? 2 * size : size;
  i = (i % period + period) % period;
  return i < size ? i : period - 1 - i;
}

/// A corner of a triangle's piece: where it is, and its place in the texture, in texels.
struct Corner {
  glm::dvec3 position;
  glm::dvec2 texel;
};
using Polygon = std::vector<Corner>;

/// The part of `in` with sign * (texel_axis - line) <= 0.
Polygon clip(const Polygon& in, int axis, double line, double sign) {
  Polygon out;
  for (std::size_t c = 0; c < in.size(); ++c) {
    const Corner &a = in[c], &b = in[(c + 1) % in.size()];
    const double da = sign * (a.texel[axis] - line), db = sign * (b.texel[axis] - line);
    if (da <= 0) out.push_back(a);
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
      const double t = da / (da - db);
      out.push_back({glm::mix(a.position, b.position, t), glm::mix(a.texel, b.texel, t)});
      out.back().texel[axis] = line;
    }
  }
  return out;
}

/// What shines alike: triangles, their area, m^2, and the integral of the texture over it.
struct Shine {
  Mesh mesh;
  double area = 0;
  glm::dvec3 sum{0};

  void add(const Polygon& polygon, glm::vec3 colour) {
    const unsigned first = unsigned(mesh.positions.size());
    for (const Corner& corner : polygon) mesh.positions.push_back(glm::vec3(corner.position));
    for (unsigned c = 1; c + 1 < polygon.size(); ++c) {
      const std::vector<glm::vec3>& p = mesh.positions;
      const glm::dvec3 a = p[first], ab = glm::dvec3(p[first + c]) - a, ac = glm::dvec3(p[first + c + 1]) - a;
      const double size = 0.5 * glm::length(glm::cross(ab, ac));
      if (size <= 0) continue;
      mesh.triangles.push_back({first, first + c, first + c + 1});
      area += size;
      sum += size * glm::dvec3(colour);
    }
  }
};

/// Texels in parts: the part with the widest range in one channel is parted in its middle until there are enough.
class Palette {
 public:
  explicit Palette(std::vector<glm::vec3> colours) {
    parts_.push_back(std::move(colours));
    while (parts_.size() < most_emission_parts) {
      std::size_t widest = 0;
      float most = 0;
      int channel = 0;
      for (std::size_t i = 0; i < parts_.size(); ++i)
        for (int c = 0; c < 3; ++c) {
          const float width = range(parts_[i], c).y - range(parts_[i], c).x;
          if (width > most) most = width, widest = i, channel = c;
        }
      if (most == 0) break;
      const glm::vec2 ends = range(parts_[widest], channel);
      const auto middle = std::partition(parts_[widest].begin(), parts_[widest].end(),
                                         [&](glm::vec3 v) { return v[channel] < 0.5f * (ends.x + ends.y); });
      std::vector<glm::vec3> upper(middle, parts_[widest].end());
      parts_[widest].erase(middle, parts_[widest].end());
      parts_.push_back(std::move(upper));
    }
    for (std::size_t i = 0; i < parts_.size(); ++i)
      for (glm::vec3 v : parts_[i]) part_of_[{v.x, v.y, v.z}] = i;
  }
  std::size_t part(glm::vec3 v) const { return part_of_.at({v.x, v.y, v.z}); }
  std::size_t size() const { return parts_.size(); }

 private:
  static glm::vec2 range(const std::vector<glm::vec3>& colours, int c) {
    const auto [low, high] =
        std::minmax_element(colours.begin(), colours.end(), [c](glm::vec3 a, glm::vec3 b) { return a[c] < b[c]; });
    return {(*low)[c], (*high)[c]};
  }
  std::vector<std::vector<glm::vec3>> parts_;
  std::map<std::array<float, 3>, std::size_t> part_of_;
};

}  // namespace

glm::vec3 EmissionTexture::at(glm::ivec2 texel) const {
  return texels[wrapped(texel.x, size.x, wrap[0]) + std::size_t(size.x) * wrapped(texel.y, size.y, wrap[1])];
}

EmissionTexture reduced(EmissionTexture texture) {
  while (texture.size.x * texture.size.y > most_emission_texels) {
    const glm::ivec2 half = glm::max(texture.size / 2, 1);
    EmissionTexture small = texture;
    small.size = half;
    small.texels.assign(std::size_t(half.x) * half.y, glm::vec3(0));
    for (int y = 0; y < half.y; ++y)
      for (int x = 0; x < half.x; ++x) {
        const glm::ivec2 from = texture.size * glm::ivec2(x, y) / half,
                         to = texture.size * glm::ivec2(x + 1, y + 1) / half;
        glm::dvec3 sum(0);
        for (int v = from.y; v < to.y; ++v)
          for (int u = from.x; u < to.x; ++u) sum += glm::dvec3(texture.texels[u + std::size_t(texture.size.x) * v]);
        small.texels[x + std::size_t(half.x) * y] = glm::vec3(sum / double((to.x - from.x) * (to.y - from.y)));
      }
    texture = std::move(small);
  }
  return texture;
}

EmissionTexture decode_emission(const std::vector<unsigned char>& bytes, const std::string& place) {
  tinygltf::Image image;
  std::string error, warning;
  if (bytes.empty() ||
      !tinygltf::LoadImageData(&image, 0, &error, &warning, 0, 0, bytes.data(), int(bytes.size()), nullptr) ||
      image.bits != 8 || image.component < 3)
    throw UserError(place + " cannot be decoded; give a PNG or JPEG of 8 bits a channel");
  EmissionTexture texture;
  texture.size = {image.width, image.height};
  for (std::size_t i = 0; i < std::size_t(image.width) * image.height; ++i) {
    const unsigned char* texel = &image.image[i * image.component];
    texture.texels.emplace_back(from_srgb(texel[0]), from_srgb(texel[1]), from_srgb(texel[2]));
  }
  return reduced(std::move(texture));
}

std::vector<Object> cut_by_texels(const Object& lamp, const std::vector<glm::vec2>& texcoords,
                                  const EmissionTexture& texture, const std::string& place) {
  const Palette palette(texture.texels);
  std::vector<Shine> shines(palette.size());
  for (glm::uvec3 t : lamp.mesh.triangles) {
    Polygon triangle;
    for (int c = 0; c < 3; ++c)
      triangle.push_back({lamp.mesh.positions[t[c]], glm::dvec2(texcoords[t[c]]) * glm::dvec2(texture.size)});
    glm::dvec2 low = triangle[0].texel, high = low;
    for (const Corner& corner : triangle) low = glm::min(low, corner.texel), high = glm::max(high, corner.texel);
    const glm::dvec2 across = high - low;
    if (!((across.x + 1) * (across.y + 1) <= 4.0 * most_emission_texels) || !(glm::length(low) < 1e6))
      throw UserError(place + ": its emissiveTexture is repeated too often across a triangle; repeat it less");
    for (int y = int(std::floor(low.y)); y < std::max(high.y, std::floor(low.y) + 1); ++y) {
      const Polygon row = clip(clip(triangle, 1, y, -1), 1, y + 1, 1);
      for (int x = int(std::floor(low.x)); row.size() > 2 && x < std::max(high.x, std::floor(low.x) + 1); ++x) {
        const Polygon piece = clip(clip(row, 0, x, -1), 0, x + 1, 1);
        const glm::vec3 colour = texture.at({x, y});
        if (piece.size() > 2) shines[palette.part(colour)].add(piece, colour);
      }
    }
  }
  std::vector<Object> parts;
  for (Shine& shine : shines) {
    if (shine.area <= 0) continue;
    Object part = lamp;
    part.mesh = std::move(shine.mesh);
    part.radiance = glm::vec3(glm::dvec3(lamp.radiance) * shine.sum / shine.area);
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace alabaster
