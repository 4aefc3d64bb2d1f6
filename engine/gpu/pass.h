// A compute pass, made from its embedded SPIR-V. Reflection finds bindings, local size and push-constant size; a caller
// names what it binds and how many threads it needs.
#pragma once

#include <tbb/task_group.h>

#include <glm/glm.hpp>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "gpu/resources.h"

namespace alabaster::gpu {

struct BindingSlot {
  std::string name;  // as in the shader: the variable, or the first member of a block without an instance name
  std::uint32_t binding = 0;
  VkDescriptorType type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
};

struct Reflection {
  std::vector<BindingSlot> bindings;
  glm::uvec3 local_size{1};
  std::uint32_t push_bytes = 0;
  std::vector<VkFormat> vertex_inputs;  // by location, vertex stages only
};

/// One thing to bind: the shader's name for it and the resource. Images with a sampler are sampled, without are
/// storage.
struct Binding {
  Binding(const char* n, const Buffer& b) : name(n), buffer(&b) {}
  Binding(const char* n, const Image& i) : name(n), image(&i) {}
  Binding(const char* n, const Image& i, const Sampler& s) : name(n), image(&i), sampler(&s) {}
  const char* name;
  const Buffer* buffer = nullptr;
  const Image* image = nullptr;
  const Sampler* sampler = nullptr;
};
using Bindings = std::vector<Binding>;

/// Values of `layout(constant_id = n)` constants, n = 0, 1, ...
using Constants = std::vector<std::variant<std::int32_t, float>>;

/// Set layout, pipeline layout and reflected names of one or two shader stages.
class PassLayout {
 public:
  PassLayout(Context& context, const std::vector<std::string>& shaders);
  ~PassLayout();
  PassLayout(const PassLayout&) = delete;
  PassLayout& operator=(const PassLayout&) = delete;

  /// Binds all of them by name. Throws std::logic_error for a missing, unknown or mistyped one: a programmer's mistake.
  void bind(VkCommandBuffer commands, VkPipelineBindPoint point, const Bindings& bindings) const;
  void push(VkCommandBuffer commands, const void* data, std::size_t bytes) const;

  Context& context;
  std::string name;
  Reflection reflection;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  std::vector<VkShaderModule> modules;  // in the order of the shaders

 private:
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
  VkShaderStageFlags stages_ = 0;
};

/// `pipeline`, named after `layout`. Throws where `result`, which Vulkan's `call` gave with it, is an error.
VkPipeline named(const PassLayout& layout, VkPipeline pipeline, VkResult result, const char* call);

/// A pipeline that a thread of its own makes: a driver takes milliseconds for each, and nothing needs it before its
/// first dispatch.
class Pipeline {
 public:
  template <class Make>
  Pipeline(Context& context, Make make) : context_(context) {
    group_.run([this, make = std::move(make)] { pipeline_ = make(); });
  }
  ~Pipeline() noexcept;
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  /// Waits for it. Throws what `make` threw.
  VkPipeline get() const {
    group_.wait();
    return pipeline_;
  }

 private:
  Context& context_;
  VkPipeline pipeline_ = VK_NULL_HANDLE;
  mutable tbb::task_group group_;
};

class Pass {
 public:
  /// `shader` is its path below shaders/, for example "diffusion/residual.comp"; also its name in labels and timers.
  Pass(Context& context, const std::string& shader, const Constants& constants = {});
  Pass(const Pass&) = delete;
  Pass& operator=(const Pass&) = delete;

  const std::string& name() const { return layout_.name; }
  const PassLayout& layout() const { return layout_; }
  VkPipeline pipeline() const { return pipeline_.get(); }
  /// Workgroups that cover `threads`, rounded up.
  glm::uvec3 groups(glm::uvec3 threads) const {
    return (threads + layout_.reflection.local_size - 1u) / layout_.reflection.local_size;
  }

 private:
  PassLayout layout_;
  Pipeline pipeline_;
};

/// Specialisation constants in the form Vulkan takes; keeps the data alive.
struct Specialisation {
  explicit Specialisation(const Constants& constants);
  std::vector<std::uint32_t> words;
  std::vector<VkSpecializationMapEntry> entries;
  VkSpecializationInfo info{};
};

}  // namespace alabaster::gpu
