// Buffers and images: one allocation each, named, freed with the object. Images live in the GENERAL layout from birth,
// so no caller thinks about layouts.
#pragma once

#include <cstring>
#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "gpu/context.h"

namespace alabaster::gpu {

// host: mapped for the CPU. staging: the same, but only copied from and to, so that it may be larger than what a shader
// can bind.
enum class Memory { device, host, staging };

class Buffer {
 public:
  Buffer() = default;
  Buffer(Context& context, std::size_t bytes, const std::string& name, Memory memory = Memory::device);
  ~Buffer() { reset(); }
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    swap(other);
    return *this;
  }

  VkBuffer handle() const { return buffer_; }
  std::size_t bytes() const { return bytes_; }
  void* mapped() const { return mapped_; }  // null for Memory::device
  explicit operator bool() const { return buffer_ != VK_NULL_HANDLE; }
  void reset();

 private:
  void swap(Buffer& other) noexcept;
  Context* context_ = nullptr;
  VkBuffer buffer_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  std::size_t bytes_ = 0;
  void* mapped_ = nullptr;
};

struct ImageSpec {
  glm::ivec3 size{1};  // texels; z = 1 for 2D
  VkFormat format = VK_FORMAT_R32_SFLOAT;
  VkImageType type = VK_IMAGE_TYPE_3D;
  VkImageUsageFlags usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                            VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  std::uint32_t layers = 1;  // 2D arrays
  VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
};

class Image {
 public:
  Image() = default;
  Image(Context& context, const ImageSpec& spec, const std::string& name);
  ~Image() { reset(); }
  Image(Image&& other) noexcept { swap(other); }
  Image& operator=(Image&& other) noexcept {
    swap(other);
    return *this;
  }

  VkImage handle() const { return image_; }
  /// The whole image (a 2D-array view where it has layers).
  VkImageView view() const { return view_; }
  /// One layer, as a render target.
  VkImageView layer_view(std::uint32_t layer) const { return layer_views_.empty() ? view_ : layer_views_[layer]; }
  const ImageSpec& spec() const { return spec_; }
  VkImageAspectFlags aspect() const;
  std::size_t bytes() const;  // of its texels, tightly packed
  explicit operator bool() const { return image_ != VK_NULL_HANDLE; }
  void reset();

 private:
  void swap(Image& other) noexcept;
  Context* context_ = nullptr;
  ImageSpec spec_;
  VkImage image_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  VkImageView view_ = VK_NULL_HANDLE;
  std::vector<VkImageView> layer_views_;
};

/// A 3D image for compute: storage, sampled and transfer use.
Image image3d(Context& context, glm::ivec3 size, VkFormat format, const std::string& name);

/// Bytes of one texel of the formats used here. Throws DeviceError for another.
std::size_t texel_bytes(VkFormat format);

enum class Filter { nearest, linear };
class Sampler {
 public:
  /// Clamps to the edge. With `compare`, a depth-comparison sampler (LESS_OR_EQUAL).
  Sampler(Context& context, Filter filter, bool compare = false);
  ~Sampler();
  Sampler(const Sampler&) = delete;
  Sampler& operator=(const Sampler&) = delete;
  VkSampler handle() const { return sampler_; }

 private:
  Context& context_;
  VkSampler sampler_ = VK_NULL_HANDLE;
};

// Whole-resource copies between host and device, through a staging buffer; each waits for the device.
void upload_bytes(Context& context, const Buffer& to, const void* data, std::size_t bytes);
void upload_bytes(Context& context, const Image& to, const void* data, std::size_t bytes);
void download_bytes(Context& context, const Buffer& from, void* data, std::size_t bytes);
void download_bytes(Context& context, const Image& from, void* data, std::size_t bytes);

/// A copy that the host reads in place (mapped()), of what is too large to be held twice.
Buffer host_copy(Context& context, const Image& from);

template <class T>
Buffer make_buffer(Context& context, const std::vector<T>& data, const std::string& name) {
  Buffer buffer(context, data.size() * sizeof(T), name);
  if (!data.empty()) upload_bytes(context, buffer, data.data(), data.size() * sizeof(T));
  return buffer;
}

template <class T, class Resource>
void upload(Context& context, const Resource& to, const std::vector<T>& data) {
  upload_bytes(context, to, data.data(), data.size() * sizeof(T));
}

template <class T, class Resource>
std::vector<T> download(Context& context, const Resource& from) {
  std::vector<T> data(from.bytes() / sizeof(T));
  download_bytes(context, from, data.data(), data.size() * sizeof(T));
  return data;
}

}  // namespace alabaster::gpu
