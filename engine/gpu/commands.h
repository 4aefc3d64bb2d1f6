// Records work and runs it. Every dispatch is followed by a barrier unless the caller says that the next one is
// independent, so passes read what the passes before them wrote.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "gpu/pass.h"
#include "gpu/raster.h"

namespace alabaster::gpu {

/// Nothing to push.
struct NoPush {};

class Commands {
 public:
  explicit Commands(Context& context);  // starts recording
  ~Commands();
  Commands(const Commands&) = delete;
  Commands& operator=(const Commands&) = delete;

  template <class Push = NoPush>
  void dispatch(const Pass& pass, glm::uvec3 threads, const Bindings& bindings, const Push& push = {}) {
    prepare(pass, bindings, &push, push_bytes<Push>());
    const glm::uvec3 n = pass.groups(threads);
    vkCmdDispatch(commands_, n.x, n.y, n.z);
    finish_dispatch();
  }

  /// As many workgroups as the first three words of `groups` say when it is their turn.
  template <class Push = NoPush>
  void dispatch_indirect(const Pass& pass, const Buffer& groups, const Bindings& bindings, const Push& push = {}) {
    prepare(pass, bindings, &push, push_bytes<Push>());
    vkCmdDispatchIndirect(commands_, groups.handle(), 0);
    finish_dispatch();
  }

  /// Dispatches recorded inside `body` do not wait for one another; a barrier follows the last.
  template <class Body>
  void concurrent(Body body) {
    const bool before = barriers_;
    barriers_ = false;
    body();
    barriers_ = before;
    barrier();
  }

  /// Keeps a buffer that only these commands use for as long as they may run.
  const Buffer& keep(Buffer buffer);

  void barrier();
  void fill(const Buffer& buffer, std::uint32_t word = 0);
  void clear(const Image& image, glm::vec4 value = glm::vec4(0));
  void copy(const Buffer& from, const Buffer& to, std::size_t bytes, std::size_t from_offset = 0,
            std::size_t to_offset = 0);
  void copy(const Image& from, const Image& to);
  void to_general(const Image& image);

  // Raster: begin, any number of draws, end.
  void begin_rendering(const Targets& targets);
  template <class Push = NoPush>
  void draw(const RasterPass& pass, const Bindings& bindings, const Geometry& geometry, const Push& push = {}) {
    vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_GRAPHICS, pass.pipeline());
    pass.layout().bind(commands_, VK_PIPELINE_BIND_POINT_GRAPHICS, bindings);
    pass.layout().push(commands_, &push, push_bytes<Push>());
    draw_geometry(geometry);
  }
  void end_rendering();

  /// Times what is recorded while the returned scope lives, on the device, under `stage` (Context::timings), and labels
  /// it.
  class Scope {
   public:
    Scope(Commands& commands, const std::string& stage);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    Commands& commands_;
    std::size_t row_;
  };
  [[nodiscard]] Scope time(const std::string& stage) { return Scope(*this, stage); }

  /// Ends the recording (once), runs it and waits. May be called again: the same commands run again.
  void submit();
  /// submit() in two steps, for work on the CPU in between; only such work that uses nothing of what these commands
  /// use.
  void start();
  void wait();

  Context& context() { return context_; }
  VkCommandBuffer handle() const { return commands_; }

 private:
  template <class Push>
  static constexpr std::size_t push_bytes() {
    return std::is_same_v<Push, NoPush> ? 0 : sizeof(Push);
  }
  void prepare(const Pass& pass, const Bindings& bindings, const void* push, std::size_t bytes);
  void finish_dispatch();
  void draw_geometry(const Geometry& geometry);
  void collect_timings();

  Context& context_;
  VkCommandBuffer commands_ = VK_NULL_HANDLE;
  VkFence fence_ = VK_NULL_HANDLE;
  VkQueryPool queries_ = VK_NULL_HANDLE;
  std::deque<Buffer> kept_;
  std::vector<std::string> stages_;  // one timer row each: queries 2 * row and 2 * row + 1
  bool barriers_ = true;
  bool recording_ = true, running_ = false;
};

}  // namespace alabaster::gpu
