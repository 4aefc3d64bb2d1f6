// The sums a reference picture is made of, and the file that keeps them over an interruption.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "image/picture.h"
#include "reference/paths.h"
#include "reference/reference.h"

namespace alabaster {

/// Of one pixel. Samples are added one by one in their order, so the sums are the same bits however a run is divided.
struct PixelSums {
  std::array<double, 9> layers{};             // multiple, single, surface; r, g, b innermost
  std::array<double, 9> layer_squares{};      // likewise
  std::array<double, 3> square{};             // of the sum of the chosen layers
  std::array<double, 3> subsurface_square{};  // of that less `surface`
  double on_object = 0;
  void add(const PathSample& sample, const std::array<bool, layer_count>& chosen);
};

struct Sums {
  int width = 0, height = 0;
  std::uint64_t fingerprint = 0;  // of the scene and of every option that changes a sample
  std::uint64_t samples = 0;      // per pixel
  std::uint64_t events = 0, capped = 0, leaks = 0;
  double seconds = 0;
  std::vector<PixelSums> pixels;

  /// sqrt(mean variance) / mean over the pixels that are wholly on a translucent object (all, where none is); the
  /// variance is that of the pixel mean, both of the chosen layers alone. 0 before there are two samples.
  double relative_error(const std::array<bool, layer_count>& chosen) const;
  void write_layers(Picture& picture, const std::array<bool, layer_count>& chosen) const;

  void save(const std::string& path) const;
  /// False where there is no such file. Throws UserError where the file is of another scene or broken.
  bool load(const std::string& path);
};

/// A hash (FNV-1a) of everything in the scene that light can see.
std::uint64_t fingerprint_of(const Scene& scene);
std::uint64_t fingerprint_of(const void* data, std::size_t bytes, std::uint64_t so_far);

}  // namespace alabaster
