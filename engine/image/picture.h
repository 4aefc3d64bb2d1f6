// A layered picture in memory, and its way to and from files. Rows run from the top, channels are planar floats.
#pragma once

#include <map>
#include <string>
#include <variant>
#include <vector>

namespace alabaster {

using Attribute = std::variant<double, std::string>;

/// Named planes of one size. Names are EXR channel names: "R", "multiple.G", "N.X", "Z", "object.Y", "variance.R".
struct Picture {
  int width = 0, height = 0;
  std::map<std::string, std::vector<float>> channels;  // each width * height, row-major from the top
  std::map<std::string, Attribute> attributes;         // EXR header attributes

  std::vector<float>& plane(const std::string& name);  // made, zero-filled, where it is missing
  bool has(const std::string& name) const { return channels.count(name) != 0; }
};

/// Writes all channels as 32-bit float (or, with `half`, 16-bit where the value fits) and all attributes. The file
/// appears whole or not at all (written beside and renamed). Throws UserError naming the file.
void write_exr(const Picture& picture, const std::string& path, bool half = false);

/// Reads any scanline or tiled EXR: every channel, float or half, and its string, int, float and double attributes.
Picture read_exr(const std::string& path);

enum class Curve { srgb, filmic };
/// R, G, B through 2^exposure (stops) and the curve, to an 8-bit sRGB PNG; whole or not at all.
void write_png(const Picture& picture, const std::string& path, double exposure = 0, Curve curve = Curve::srgb);

/// 8-bit RGB, row-major from the top, to PNG (for sheets and plots).
void write_png_rgb8(int width, int height, const std::vector<unsigned char>& rgb, const std::string& path);

/// The same to JPEG, `quality` 1 to 100.
void write_jpeg_rgb8(int width, int height, const std::vector<unsigned char>& rgb, int quality,
                     const std::string& path);

}  // namespace alabaster
