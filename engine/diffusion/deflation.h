// The islands of all channels, on the device.
#pragma once

#include <vector>

#include "gpu/resources.h"
#include "shared/diffusion.h"

namespace alabaster {

class Deflation {
 public:
  Deflation() = default;
  /// Finds the islands of the finest stencil; `media`: how rough each channel's medium is.
  Deflation(gpu::Context& context, const gpu::Image& stencil, glm::ivec3 cells, const std::vector<Roughness>& media);

  int count() const { return count_; }              // of all channels
  double noise() const { return noise_; }           // of the worst channel's medium: noise_share
  bool rough() const { return rough_; }             // any channel's medium: is_rough
  std::uint32_t pieces() const { return pieces_; }  // of all islands
  const gpu::Buffer& piece_list() const { return piece_list_; }
  const gpu::Buffer& pieces_of() const { return pieces_of_; }  // IslandPieces of every island
  const gpu::Buffer& sums() const { return sums_; }            // of every piece
  const gpu::Buffer& entries() const { return entries_; }
  const gpu::Buffer& labels() const { return labels_; }  // of every cell and channel; with no islands one uvec4
  const gpu::Buffer& lifts() const { return lifts_; }    // islands.comp

 private:
  int count_ = 0;
  double noise_ = 0;
  bool rough_ = false;
  std::uint32_t pieces_ = 0;
  gpu::Buffer piece_list_, pieces_of_, sums_, entries_, labels_, lifts_;
};

}  // namespace alabaster
