#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

#include <cmath>
#include <stdexcept>

#include "image/picture.h"
#include "image/whole_file.h"
#include "scene/error.h"

namespace alabaster {
namespace {

void append(void* context, void* data, int size) {
  static_cast<std::string*>(context)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
}

// K. Narkowicz, "ACES Filmic Tone Mapping Curve", 2015: his rational fit, scene-linear in, display-linear out.
double filmic(double x) { return x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14); }

// IEC 61966-2-1.
double srgb_transfer(double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1.0 / 2.4) - 0.055; }

unsigned char encode(double linear, Curve curve) {
  if (!(linear > 0)) return 0;  // also NaN
  linear = std::min(linear, 1e6);
  double shown = curve == Curve::filmic ? filmic(linear) : linear;
  return static_cast<unsigned char>(std::lround(255.0 * srgb_transfer(std::min(shown, 1.0))));
}

}  // namespace

void write_png_rgb8(int width, int height, const std::vector<unsigned char>& rgb, const std::string& path) {
  if (rgb.size() != 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
    throw std::logic_error("write_png_rgb8: not 3 * width * height bytes");
  std::string bytes;
  if (!stbi_write_png_to_func(append, &bytes, width, height, 3, rgb.data(), 3 * width))
    throw UserError(path + ": the picture could not be encoded as PNG; try a smaller size");
  write_whole_file(path, bytes);
}

void write_jpeg_rgb8(int width, int height, const std::vector<unsigned char>& rgb, int quality,
                     const std::string& path) {
  if (rgb.size() != 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
    throw std::logic_error("write_jpeg_rgb8: not 3 * width * height bytes");
  std::string bytes;
  if (!stbi_write_jpg_to_func(append, &bytes, width, height, 3, rgb.data(), quality))
    throw UserError(path + ": the picture could not be encoded as JPEG; try a smaller size");
  write_whole_file(path, bytes);
}

void write_png(const Picture& picture, const std::string& path, double exposure, Curve curve) {
  const char* names[3] = {"R", "G", "B"};
  const std::vector<float>* planes[3];
  for (int c = 0; c < 3; ++c) {
    auto found = picture.channels.find(names[c]);
    if (found == picture.channels.end())
      throw UserError(path + ": the picture has no channel " + names[c] + " to show");
    planes[c] = &found->second;
  }
  const double gain = std::exp2(exposure);
  std::vector<unsigned char> rgb(3 * planes[0]->size());
  for (std::size_t i = 0; i < planes[0]->size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) rgb[3 * i + c] = encode(gain * static_cast<double>((*planes[c])[i]), curve);
  write_png_rgb8(picture.width, picture.height, rgb, path);
}

}  // namespace alabaster
