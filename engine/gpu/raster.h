// A raster pass (vertex and fragment shader) for dynamic rendering, its targets and its geometry.
#pragma once

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "gpu/pass.h"

namespace alabaster::gpu {

struct RasterOptions {
  std::vector<VkFormat> color;           // of the colour targets, in order
  VkFormat depth = VK_FORMAT_UNDEFINED;  // UNDEFINED: no depth test
  VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
  VkCullModeFlags cull = VK_CULL_MODE_NONE;
  VkCompareOp depth_compare = VK_COMPARE_OP_LESS_OR_EQUAL;
  float depth_bias = 0, depth_slope_bias = 0;
  Constants constants;  // of both stages
};

class RasterPass {
 public:
  /// Vertex inputs are read from one buffer, interleaved and tightly packed in the order of their locations.
  RasterPass(Context& context, const std::string& vertex, const std::string& fragment, const RasterOptions& options);
  RasterPass(const RasterPass&) = delete;
  RasterPass& operator=(const RasterPass&) = delete;
  const PassLayout& layout() const { return layout_; }
  VkPipeline pipeline() const { return pipeline_.get(); }

 private:
  PassLayout layout_;
  Pipeline pipeline_;
};

struct Target {
  const Image* image = nullptr;
  const Image* resolve = nullptr;  // single-sample image that receives the average
  glm::vec4 clear{0};
  std::uint32_t layer = 0;
};

/// Colour targets are cleared to their `clear`; depth to 1.
struct Targets {
  glm::ivec2 size{0};
  std::vector<Target> color;
  const Image* depth = nullptr;
  std::uint32_t depth_layer = 0;
};

/// Indexed (uint32) triangles, or `count` vertices without a buffer where `vertices` is null.
struct Geometry {
  const Buffer* vertices = nullptr;
  const Buffer* indices = nullptr;
  std::uint32_t count = 0;  // indices, or vertices
  std::uint32_t first = 0;
};

}  // namespace alabaster::gpu
