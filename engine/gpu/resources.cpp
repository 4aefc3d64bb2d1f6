#include "gpu/resources.h"

#include <algorithm>
#include <utility>

#include "gpu/commands.h"

namespace alabaster::gpu {

Buffer::Buffer(Context& context, std::size_t bytes, const std::string& name, Memory memory)
    : context_(&context), bytes_(std::max<std::size_t>(bytes, 16)) {
  // Checked here because validation reports it only at the draw or dispatch that binds the buffer.
  const bool staging = memory == Memory::staging;
  if (!staging && bytes_ > context.limits().maxStorageBufferRange)
    throw DeviceError(name + ": " + std::to_string(bytes_ >> 20) + " MiB is more than one storage buffer holds on " +
                      context.info().name + "; choose a smaller --grid or --size");
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.size = bytes_;
  info.usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  if (!staging)
    info.usage |= VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
                  VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_INDEX_BUFFER_BIT |
                  VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT;
  check(vkCreateBuffer(context.device(), &info, nullptr, &buffer_), name + ": vkCreateBuffer");
  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(context.device(), buffer_, &needs);
  try {
    memory_ = context.allocate(needs, memory != Memory::device, name);
  } catch (...) {
    reset();
    throw;
  }
  check(vkBindBufferMemory(context.device(), buffer_, memory_, 0), name + ": vkBindBufferMemory");
  if (memory != Memory::device)
    check(vkMapMemory(context.device(), memory_, 0, VK_WHOLE_SIZE, 0, &mapped_), name + ": vkMapMemory");
  context.name(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<std::uint64_t>(buffer_), name);
}

void Buffer::swap(Buffer& other) noexcept {
  std::swap(context_, other.context_);
  std::swap(buffer_, other.buffer_);
  std::swap(memory_, other.memory_);
  std::swap(bytes_, other.bytes_);
  std::swap(mapped_, other.mapped_);
}

void Buffer::reset() {
  if (!context_) return;
  if (buffer_) vkDestroyBuffer(context_->device(), buffer_, nullptr);
  if (memory_) context_->release(memory_);
  buffer_ = VK_NULL_HANDLE;
  memory_ = VK_NULL_HANDLE;
  bytes_ = 0;
  mapped_ = nullptr;
  context_ = nullptr;
}

std::size_t texel_bytes(VkFormat format) {
  switch (format) {
    case VK_FORMAT_R8_UNORM:
      return 1;
    case VK_FORMAT_R16_SFLOAT:
      return 2;
    case VK_FORMAT_R8G8B8A8_UNORM:
    case VK_FORMAT_R8G8B8A8_SRGB:
    case VK_FORMAT_B8G8R8A8_UNORM:
    case VK_FORMAT_B8G8R8A8_SRGB:
    case VK_FORMAT_R32_SFLOAT:
    case VK_FORMAT_R32_UINT:
    case VK_FORMAT_R32_SINT:
    case VK_FORMAT_D32_SFLOAT:
      return 4;
    case VK_FORMAT_R16G16B16A16_SFLOAT:
    case VK_FORMAT_R32G32_UINT:
    case VK_FORMAT_R32G32_SFLOAT:
      return 8;
    case VK_FORMAT_R32G32B32A32_SFLOAT:
    case VK_FORMAT_R32G32B32A32_UINT:
      return 16;
    default:
      throw DeviceError("texel_bytes: format " + std::to_string(format) + " is not in its list");
  }
}

Image::Image(Context& context, const ImageSpec& spec, const std::string& name) : context_(&context), spec_(spec) {
  const std::uint32_t limit =
      spec.type == VK_IMAGE_TYPE_3D ? context.limits().maxImageDimension3D : context.limits().maxImageDimension2D;
  for (int axis = 0; axis < 3; ++axis)
    if (spec.size[axis] < 1 || static_cast<std::uint32_t>(spec.size[axis]) > limit)
      throw DeviceError(name + ": " + std::to_string(spec.size[axis]) + " texels along axis " + std::to_string(axis) +
                        " where " + context.info().name + " allows 1 to " + std::to_string(limit) +
                        "; choose a smaller --grid or --size");
  VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  info.imageType = spec.type;
  info.format = spec.format;
  info.extent = {static_cast<std::uint32_t>(spec.size.x), static_cast<std::uint32_t>(spec.size.y),
                 static_cast<std::uint32_t>(spec.size.z)};
  info.mipLevels = 1;
  info.arrayLayers = spec.layers;
  info.samples = spec.samples;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = spec.usage;
  check(vkCreateImage(context.device(), &info, nullptr, &image_), name + ": vkCreateImage");
  VkMemoryRequirements needs;
  vkGetImageMemoryRequirements(context.device(), image_, &needs);
  try {
    memory_ = context.allocate(needs, false, name);
  } catch (...) {
    reset();
    throw;
  }
  check(vkBindImageMemory(context.device(), image_, memory_, 0), name + ": vkBindImageMemory");

  VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
  view.image = image_;
  view.format = spec.format;
  view.viewType = spec.type == VK_IMAGE_TYPE_3D ? VK_IMAGE_VIEW_TYPE_3D
                  : spec.layers > 1             ? VK_IMAGE_VIEW_TYPE_2D_ARRAY
                                                : VK_IMAGE_VIEW_TYPE_2D;
  view.subresourceRange = {aspect(), 0, 1, 0, spec.layers};
  check(vkCreateImageView(context.device(), &view, nullptr, &view_), name + ": vkCreateImageView");
  if (spec.layers > 1) {
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    layer_views_.resize(spec.layers);
    for (std::uint32_t layer = 0; layer < spec.layers; ++layer) {
      view.subresourceRange.baseArrayLayer = layer;
      view.subresourceRange.layerCount = 1;
      check(vkCreateImageView(context.device(), &view, nullptr, &layer_views_[layer]), name + ": vkCreateImageView");
    }
  }
  context.name(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<std::uint64_t>(image_), name);

  Commands commands(context);
  commands.to_general(*this);
  commands.submit();
}

VkImageAspectFlags Image::aspect() const {
  return spec_.format == VK_FORMAT_D32_SFLOAT ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

std::size_t Image::bytes() const {
  return texel_bytes(spec_.format) * static_cast<std::size_t>(spec_.size.x) * static_cast<std::size_t>(spec_.size.y) *
         static_cast<std::size_t>(spec_.size.z) * spec_.layers;
}

void Image::swap(Image& other) noexcept {
  std::swap(context_, other.context_);
  std::swap(spec_, other.spec_);
  std::swap(image_, other.image_);
  std::swap(memory_, other.memory_);
  std::swap(view_, other.view_);
  std::swap(layer_views_, other.layer_views_);
}

void Image::reset() {
  if (!context_) return;
  for (VkImageView view : layer_views_) vkDestroyImageView(context_->device(), view, nullptr);
  if (view_) vkDestroyImageView(context_->device(), view_, nullptr);
  if (image_) vkDestroyImage(context_->device(), image_, nullptr);
  if (memory_) context_->release(memory_);
  layer_views_.clear();
  view_ = VK_NULL_HANDLE;
  image_ = VK_NULL_HANDLE;
  memory_ = VK_NULL_HANDLE;
  context_ = nullptr;
}

Image image3d(Context& context, glm::ivec3 size, VkFormat format, const std::string& name) {
  ImageSpec spec;
  spec.size = size;
  spec.format = format;
  return Image(context, spec, name);
}

Sampler::Sampler(Context& context, Filter filter, bool compare) : context_(context) {
  VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  info.magFilter = info.minFilter = filter == Filter::linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
  info.addressModeU = info.addressModeV = info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  info.compareEnable = compare;
  info.compareOp = VK_COMPARE_OP_LESS_OR_EQUAL;
  check(vkCreateSampler(context.device(), &info, nullptr, &sampler_), "vkCreateSampler");
}

Sampler::~Sampler() { vkDestroySampler(context_.device(), sampler_, nullptr); }

namespace {

// Bytes of staging at once: a large image and its copy need not be there together.
constexpr std::size_t piece_bytes = std::size_t(16) << 20;

/// Planes of an image along z.
struct Slab {
  int first, count;
};

VkBufferImageCopy copy_of(const Image& image, Slab slab) {
  const glm::uvec3 size(image.spec().size);
  VkBufferImageCopy copy{};
  copy.imageSubresource = {image.aspect(), 0, 0, image.spec().layers};
  copy.imageOffset = {0, 0, slab.first};
  copy.imageExtent = {size.x, size.y, static_cast<std::uint32_t>(slab.count)};
  return copy;
}

Slab whole(const Image& image) { return {0, image.spec().size.z}; }

template <class Resource>
void expect_fits(const Resource& resource, std::size_t bytes) {
  if (bytes > resource.bytes()) throw std::logic_error("copy of more bytes than the resource holds");
}

void record_copy(Commands& commands, const Buffer& from, const Buffer& to, std::size_t bytes) {
  const VkBufferCopy copy{0, 0, bytes};
  vkCmdCopyBuffer(commands.handle(), from.handle(), to.handle(), 1, &copy);
}
void record_copy(Commands& commands, const Buffer& from, const Image& to, Slab slab) {
  const VkBufferImageCopy copy = copy_of(to, slab);
  vkCmdCopyBufferToImage(commands.handle(), from.handle(), to.handle(), VK_IMAGE_LAYOUT_GENERAL, 1, &copy);
}
void record_copy(Commands& commands, const Image& from, const Buffer& to, Slab slab) {
  const VkBufferImageCopy copy = copy_of(from, slab);
  vkCmdCopyImageToBuffer(commands.handle(), from.handle(), VK_IMAGE_LAYOUT_GENERAL, to.handle(), 1, &copy);
}

template <class Resource, class Part>
void put(Context& context, const Resource& to, Part part, const void* data, std::size_t bytes) {
  Buffer staging(context, bytes, "staging", Memory::staging);
  std::memcpy(staging.mapped(), data, bytes);
  Commands commands(context);
  record_copy(commands, staging, to, part);
  commands.submit();
}

template <class Resource, class Part>
Buffer staged(Context& context, const Resource& from, Part part, std::size_t bytes) {
  Buffer staging(context, bytes, "staging", Memory::staging);
  Commands commands(context);
  record_copy(commands, from, staging, part);
  commands.barrier();
  commands.submit();
  return staging;
}

/// Calls move(slab, first byte, bytes) for one part of the image after the other.
template <class Move>
void in_pieces(const Image& image, std::size_t bytes, Move move) {
  if (bytes != image.bytes()) throw std::logic_error("an image is copied whole");
  const Slab all = whole(image);
  const std::size_t plane = bytes / all.count;
  const int most = static_cast<int>(std::clamp(piece_bytes / plane, std::size_t(1), std::size_t(all.count)));
  for (int z = 0; z < all.count; z += most) {
    const Slab slab{z, std::min(most, all.count - z)};
    move(slab, z * plane, slab.count * plane);
  }
}

}  // namespace

Buffer host_copy(Context& context, const Image& from) { return staged(context, from, whole(from), from.bytes()); }

void upload_bytes(Context& c, const Buffer& to, const void* data, std::size_t bytes) {
  expect_fits(to, bytes);
  if (!to.mapped()) return put(c, to, bytes, data, bytes);
  std::memcpy(to.mapped(), data, bytes);
}
void upload_bytes(Context& c, const Image& to, const void* data, std::size_t bytes) {
  in_pieces(to, bytes, [&](Slab slab, std::size_t first, std::size_t size) {
    put(c, to, slab, static_cast<const std::byte*>(data) + first, size);
  });
}
void download_bytes(Context& c, const Buffer& from, void* data, std::size_t bytes) {
  expect_fits(from, bytes);
  const Buffer staging = from.mapped() ? Buffer() : staged(c, from, bytes, bytes);
  std::memcpy(data, from.mapped() ? from.mapped() : staging.mapped(), bytes);
}
void download_bytes(Context& c, const Image& from, void* data, std::size_t bytes) {
  in_pieces(from, bytes, [&](Slab slab, std::size_t first, std::size_t size) {
    std::memcpy(static_cast<std::byte*>(data) + first, staged(c, from, slab, size).mapped(), size);
  });
}

}  // namespace alabaster::gpu
