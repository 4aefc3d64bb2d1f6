#include "gpu/commands.h"

namespace alabaster::gpu {
namespace {

constexpr std::uint32_t timer_rows = 256;  // per Commands

VkImageSubresourceRange whole_range(const Image& image) { return {image.aspect(), 0, 1, 0, image.spec().layers}; }

}  // namespace

Commands::Commands(Context& context) : context_(context) {
  VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  allocate.commandPool = context.command_pool();
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = 1;
  check(vkAllocateCommandBuffers(context.device(), &allocate, &commands_), "vkAllocateCommandBuffers");
  VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
  check(vkCreateFence(context.device(), &fence, nullptr, &fence_), "vkCreateFence");
  VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  check(vkBeginCommandBuffer(commands_, &begin), "vkBeginCommandBuffer");
}

Commands::~Commands() {
  if (running_) vkWaitForFences(context_.device(), 1, &fence_, VK_TRUE, UINT64_MAX);
  vkDestroyQueryPool(context_.device(), queries_, nullptr);
  vkDestroyFence(context_.device(), fence_, nullptr);
  vkFreeCommandBuffers(context_.device(), context_.command_pool(), 1, &commands_);
}

void Commands::prepare(const Pass& pass, const Bindings& bindings, const void* push, std::size_t bytes) {
  vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, pass.pipeline());
  pass.layout().bind(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, bindings);
  pass.layout().push(commands_, push, bytes);
  if (context_.begin_label) {
    VkDebugUtilsLabelEXT label{VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT};
    label.pLabelName = pass.name().c_str();
    context_.begin_label(commands_, &label);
  }
}

void Commands::finish_dispatch() {
  if (context_.end_label) context_.end_label(commands_);
  if (barriers_) barrier();
}

const Buffer& Commands::keep(Buffer buffer) {
  kept_.push_back(std::move(buffer));
  return kept_.back();
}

void Commands::barrier() {
  VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  memory.srcStageMask = memory.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  memory.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  memory.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &memory;
  vkCmdPipelineBarrier2(commands_, &info);
}

void Commands::fill(const Buffer& buffer, std::uint32_t word) {
  vkCmdFillBuffer(commands_, buffer.handle(), 0, VK_WHOLE_SIZE, word);
  if (barriers_) barrier();
}

void Commands::clear(const Image& image, glm::vec4 value) {
  VkClearColorValue color{};
  for (int i = 0; i < 4; ++i) color.float32[i] = value[i];
  const VkImageSubresourceRange range = whole_range(image);
  vkCmdClearColorImage(commands_, image.handle(), VK_IMAGE_LAYOUT_GENERAL, &color, 1, &range);
  if (barriers_) barrier();
}

void Commands::copy(const Buffer& from, const Buffer& to, std::size_t bytes, std::size_t from_offset,
                    std::size_t to_offset) {
  const VkBufferCopy copy{from_offset, to_offset, bytes};
  vkCmdCopyBuffer(commands_, from.handle(), to.handle(), 1, &copy);
  if (barriers_) barrier();
}

void Commands::copy(const Image& from, const Image& to) {
  VkImageCopy copy{};
  copy.srcSubresource = {from.aspect(), 0, 0, from.spec().layers};
  copy.dstSubresource = {to.aspect(), 0, 0, to.spec().layers};
  copy.extent = {static_cast<std::uint32_t>(from.spec().size.x), static_cast<std::uint32_t>(from.spec().size.y),
                 static_cast<std::uint32_t>(from.spec().size.z)};
  vkCmdCopyImage(commands_, from.handle(), VK_IMAGE_LAYOUT_GENERAL, to.handle(), VK_IMAGE_LAYOUT_GENERAL, 1, &copy);
  if (barriers_) barrier();
}

void Commands::to_general(const Image& image) {
  VkImageMemoryBarrier2 memory{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  memory.srcStageMask = memory.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  memory.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  memory.newLayout = VK_IMAGE_LAYOUT_GENERAL;
  memory.image = image.handle();
  memory.subresourceRange = whole_range(image);
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.imageMemoryBarrierCount = 1;
  info.pImageMemoryBarriers = &memory;
  vkCmdPipelineBarrier2(commands_, &info);
}

void Commands::begin_rendering(const Targets& targets) {
  std::vector<VkRenderingAttachmentInfo> color;
  for (const Target& target : targets.color) {
    VkRenderingAttachmentInfo info{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
    info.imageView = target.image->layer_view(target.layer);
    info.imageLayout = VK_IMAGE_LAYOUT_GENERAL;
    info.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    info.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    for (int i = 0; i < 4; ++i) info.clearValue.color.float32[i] = target.clear[i];
    if (target.resolve) {
      info.resolveMode = VK_RESOLVE_MODE_AVERAGE_BIT;
      info.resolveImageView = target.resolve->view();
      info.resolveImageLayout = VK_IMAGE_LAYOUT_GENERAL;
    }
    color.push_back(info);
  }
  VkRenderingAttachmentInfo depth{VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO};
  if (targets.depth) {
    depth.imageView = targets.depth->layer_view(targets.depth_layer);
    depth.imageLayout = VK_IMAGE_LAYOUT_GENERAL;
    depth.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    depth.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    depth.clearValue.depthStencil = {1.0f, 0};
  }
  const VkExtent2D extent{static_cast<std::uint32_t>(targets.size.x), static_cast<std::uint32_t>(targets.size.y)};
  VkRenderingInfo info{VK_STRUCTURE_TYPE_RENDERING_INFO};
  info.renderArea.extent = extent;
  info.layerCount = 1;
  info.colorAttachmentCount = static_cast<std::uint32_t>(color.size());
  info.pColorAttachments = color.data();
  info.pDepthAttachment = targets.depth ? &depth : nullptr;
  vkCmdBeginRendering(commands_, &info);
  const VkViewport viewport{0, 0, static_cast<float>(targets.size.x), static_cast<float>(targets.size.y), 0, 1};
  vkCmdSetViewport(commands_, 0, 1, &viewport);
  const VkRect2D scissor{{0, 0}, extent};
  vkCmdSetScissor(commands_, 0, 1, &scissor);
}

void Commands::draw_geometry(const Geometry& geometry) {
  if (geometry.vertices) {
    const VkDeviceSize zero = 0;
    const VkBuffer buffer = geometry.vertices->handle();
    vkCmdBindVertexBuffers(commands_, 0, 1, &buffer, &zero);
  }
  if (geometry.indices) {
    vkCmdBindIndexBuffer(commands_, geometry.indices->handle(), 0, VK_INDEX_TYPE_UINT32);
    vkCmdDrawIndexed(commands_, geometry.count, 1, geometry.first, 0, 0);
  } else {
    vkCmdDraw(commands_, geometry.count, 1, geometry.first, 0);
  }
}

void Commands::end_rendering() {
  vkCmdEndRendering(commands_);
  if (barriers_) barrier();
}

Commands::Scope::Scope(Commands& commands, const std::string& stage)
    : commands_(commands), row_(commands.stages_.size()) {
  if (row_ >= timer_rows)
    throw std::logic_error("more than " + std::to_string(timer_rows) + " timer scopes in one Commands");
  if (!commands.queries_) {
    VkQueryPoolCreateInfo info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
    info.queryType = VK_QUERY_TYPE_TIMESTAMP;
    info.queryCount = 2 * timer_rows;
    check(vkCreateQueryPool(commands.context_.device(), &info, nullptr, &commands.queries_), "vkCreateQueryPool");
    vkCmdResetQueryPool(commands.commands_, commands.queries_, 0, 2 * timer_rows);
  }
  commands.stages_.push_back(stage);
  vkCmdWriteTimestamp2(commands.commands_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, commands.queries_,
                       static_cast<std::uint32_t>(2 * row_));
  commands.barrier();  // lavapipe takes the time at its next flush, which else comes after the work that is timed
}

Commands::Scope::~Scope() {
  vkCmdWriteTimestamp2(commands_.commands_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, commands_.queries_,
                       static_cast<std::uint32_t>(2 * row_ + 1));
}

void Commands::submit() {
  start();
  wait();
}

void Commands::start() {
  if (recording_) check(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
  recording_ = false;
  VkCommandBufferSubmitInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO};
  buffer.commandBuffer = commands_;
  VkSubmitInfo2 info{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
  info.commandBufferInfoCount = 1;
  info.pCommandBufferInfos = &buffer;
  check(vkResetFences(context_.device(), 1, &fence_), "vkResetFences");
  check(vkQueueSubmit2(context_.queue(), 1, &info, fence_), "vkQueueSubmit2");
  running_ = true;
}

void Commands::wait() {
  check(vkWaitForFences(context_.device(), 1, &fence_, VK_TRUE, UINT64_MAX), "vkWaitForFences");
  running_ = false;
  collect_timings();
}

void Commands::collect_timings() {
  if (stages_.empty()) return;
  std::vector<std::uint64_t> ticks(2 * stages_.size());
  check(vkGetQueryPoolResults(context_.device(), queries_, 0, static_cast<std::uint32_t>(ticks.size()),
                              ticks.size() * 8, ticks.data(), 8, VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
        "vkGetQueryPoolResults");
  const double ms = static_cast<double>(context_.limits().timestampPeriod) * 1e-6;
  for (std::size_t row = 0; row < stages_.size(); ++row)
    context_.add_timing(stages_[row], static_cast<double>(ticks[2 * row + 1] - ticks[2 * row]) * ms);
}

}  // namespace alabaster::gpu
