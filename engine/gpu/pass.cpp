#include "gpu/pass.h"

#include <spirv_cross/spirv_cross_c.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>

#include "gpu/spirv.h"

namespace alabaster::gpu {
namespace {

const SpirvEntry& find_spirv(const std::string& shader) {
  for (const SpirvEntry* entry = spirv_table; entry->name; ++entry)
    if (shader == entry->name) return *entry;
  throw std::logic_error("no shader " + shader + " is embedded");
}

VkShaderStageFlagBits stage_of(const std::string& shader) {
  const std::string ending = shader.substr(shader.rfind('.') + 1);
  if (ending == "comp") return VK_SHADER_STAGE_COMPUTE_BIT;
  if (ending == "vert") return VK_SHADER_STAGE_VERTEX_BIT;
  if (ending == "frag") return VK_SHADER_STAGE_FRAGMENT_BIT;
  throw std::logic_error(shader + ": unknown kind of shader");
}

void expect(spvc_result result, const std::string& shader) {
  if (result != SPVC_SUCCESS) throw std::logic_error(shader + ": SPIR-V reflection failed");
}

struct Kind {
  spvc_resource_type resource;
  VkDescriptorType descriptor;
};
constexpr Kind kinds[] = {{SPVC_RESOURCE_TYPE_STORAGE_BUFFER, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER},
                          {SPVC_RESOURCE_TYPE_UNIFORM_BUFFER, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER},
                          {SPVC_RESOURCE_TYPE_STORAGE_IMAGE, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE},
                          {SPVC_RESOURCE_TYPE_SAMPLED_IMAGE, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER}};

class Reflector {
 public:
  explicit Reflector(const std::string& shader) : shader_(shader) {
    const SpirvEntry& spirv = find_spirv(shader);
    spvc_context raw = nullptr;
    expect(spvc_context_create(&raw), shader);
    context_.reset(raw);
    spvc_parsed_ir ir = nullptr;
    expect(spvc_context_parse_spirv(raw, spirv.words, spirv.count, &ir), shader);
    expect(spvc_context_create_compiler(raw, SPVC_BACKEND_NONE, ir, SPVC_CAPTURE_MODE_TAKE_OWNERSHIP, &compiler_),
           shader);
    expect(spvc_compiler_create_shader_resources(compiler_, &resources_), shader);
  }

  void add_to(Reflection& r) {
    for (const Kind& kind : kinds)
      for (const spvc_reflected_resource& resource : list(kind.resource)) add_slot(r, resource, kind.descriptor);
    for (const spvc_reflected_resource& block : list(SPVC_RESOURCE_TYPE_PUSH_CONSTANT)) {
      std::size_t bytes = 0;
      expect(spvc_compiler_get_declared_struct_size(
                 compiler_, spvc_compiler_get_type_handle(compiler_, block.base_type_id), &bytes),
             shader_);
      r.push_bytes = std::max(r.push_bytes, static_cast<std::uint32_t>(bytes));
    }
    if (stage_of(shader_) == VK_SHADER_STAGE_COMPUTE_BIT)
      for (unsigned axis = 0; axis < 3; ++axis)
        r.local_size[static_cast<int>(axis)] =
            spvc_compiler_get_execution_mode_argument_by_index(compiler_, SpvExecutionModeLocalSize, axis);
    if (stage_of(shader_) == VK_SHADER_STAGE_VERTEX_BIT) add_vertex_inputs(r);
  }

 private:
  std::span<const spvc_reflected_resource> list(spvc_resource_type type) {
    const spvc_reflected_resource* first = nullptr;
    std::size_t count = 0;
    expect(spvc_resources_get_resource_list_for_type(resources_, type, &first, &count), shader_);
    return {first, count};
  }

  void add_slot(Reflection& r, const spvc_reflected_resource& resource, VkDescriptorType type) {
    BindingSlot slot;
    const char* instance = spvc_compiler_get_name(compiler_, resource.id);
    // A block without an instance name goes by its first member, which is what the shader's code says.
    slot.name = instance && *instance ? instance : spvc_compiler_get_member_name(compiler_, resource.base_type_id, 0);
    slot.binding = spvc_compiler_get_decoration(compiler_, resource.id, SpvDecorationBinding);
    slot.type = type;
    for (const BindingSlot& known : r.bindings)
      if (known.binding == slot.binding) {
        if (known.name != slot.name || known.type != slot.type)
          throw std::logic_error(shader_ + ": binding " + std::to_string(slot.binding) + " is both " + known.name +
                                 " and " + slot.name);
        return;
      }
    r.bindings.push_back(slot);
  }

  void add_vertex_inputs(Reflection& r) {
    constexpr VkFormat formats[] = {VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32_SFLOAT, VK_FORMAT_R32G32B32_SFLOAT,
                                    VK_FORMAT_R32G32B32A32_SFLOAT};
    std::map<unsigned, VkFormat> by_location;
    for (const spvc_reflected_resource& input : list(SPVC_RESOURCE_TYPE_STAGE_INPUT)) {
      const unsigned size = spvc_type_get_vector_size(spvc_compiler_get_type_handle(compiler_, input.type_id));
      by_location[spvc_compiler_get_decoration(compiler_, input.id, SpvDecorationLocation)] = formats[size - 1];
    }
    for (auto& [location, format] : by_location) r.vertex_inputs.push_back(format);
  }

  struct Destroy {
    void operator()(spvc_context c) const { spvc_context_destroy(c); }
  };
  std::string shader_;
  std::unique_ptr<std::remove_pointer_t<spvc_context>, Destroy> context_;
  spvc_compiler compiler_ = nullptr;
  spvc_resources resources_ = nullptr;
};

}  // namespace

PassLayout::PassLayout(Context& c, const std::vector<std::string>& shaders) : context(c), name(shaders.back()) {
  for (const std::string& shader : shaders) {
    Reflector(shader).add_to(reflection);
    stages_ |= stage_of(shader);
    const SpirvEntry& spirv = find_spirv(shader);
    VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    info.codeSize = spirv.count * 4;
    info.pCode = spirv.words;
    check(vkCreateShaderModule(c.device(), &info, nullptr, &modules.emplace_back()), shader + ": vkCreateShaderModule");
  }
  if (reflection.push_bytes > c.limits().maxPushConstantsSize)
    throw std::logic_error(name + ": push constants too large");

  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (const BindingSlot& slot : reflection.bindings)
    bindings.push_back({slot.binding, slot.type, 1, stages_, nullptr});
  VkDescriptorSetLayoutCreateInfo set{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
  set.flags = VK_DESCRIPTOR_SET_LAYOUT_CREATE_PUSH_DESCRIPTOR_BIT_KHR;
  set.bindingCount = static_cast<std::uint32_t>(bindings.size());
  set.pBindings = bindings.data();
  check(vkCreateDescriptorSetLayout(c.device(), &set, nullptr, &set_layout_), name + ": vkCreateDescriptorSetLayout");

  const VkPushConstantRange range{stages_, 0, reflection.push_bytes};
  VkPipelineLayoutCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
  info.setLayoutCount = 1;
  info.pSetLayouts = &set_layout_;
  info.pushConstantRangeCount = reflection.push_bytes ? 1 : 0;
  info.pPushConstantRanges = &range;
  check(vkCreatePipelineLayout(c.device(), &info, nullptr, &layout), name + ": vkCreatePipelineLayout");
}

PassLayout::~PassLayout() {
  for (VkShaderModule module : modules) vkDestroyShaderModule(context.device(), module, nullptr);
  vkDestroyPipelineLayout(context.device(), layout, nullptr);
  vkDestroyDescriptorSetLayout(context.device(), set_layout_, nullptr);
}

void PassLayout::bind(VkCommandBuffer commands, VkPipelineBindPoint point, const Bindings& bindings) const {
  constexpr std::size_t most = 32;  // maxPushDescriptors everywhere
  VkWriteDescriptorSet writes[most];
  VkDescriptorImageInfo images[most];
  VkDescriptorBufferInfo buffers[most];
  std::uint32_t n = 0;
  for (const BindingSlot& slot : reflection.bindings) {
    const auto found =
        std::find_if(bindings.begin(), bindings.end(), [&](const Binding& b) { return slot.name == b.name; });
    if (found == bindings.end()) throw std::logic_error(name + ": nothing is bound to " + slot.name);
    const bool is_image =
        slot.type == VK_DESCRIPTOR_TYPE_STORAGE_IMAGE || slot.type == VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    const bool is_sampled = slot.type == VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    if (is_image != (found->image != nullptr) || is_sampled != (found->sampler != nullptr))
      throw std::logic_error(name + ": " + slot.name + " is bound to another kind of resource");
    writes[n] = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    writes[n].dstBinding = slot.binding;
    writes[n].descriptorCount = 1;
    writes[n].descriptorType = slot.type;
    if (is_image) {
      images[n] = {is_sampled ? found->sampler->handle() : VK_NULL_HANDLE, found->image->view(),
                   VK_IMAGE_LAYOUT_GENERAL};
      writes[n].pImageInfo = &images[n];
    } else {
      buffers[n] = {found->buffer->handle(), 0, VK_WHOLE_SIZE};
      writes[n].pBufferInfo = &buffers[n];
    }
    ++n;
  }
  for (const Binding& b : bindings)
    if (std::none_of(reflection.bindings.begin(), reflection.bindings.end(),
                     [&](const BindingSlot& s) { return s.name == b.name; }))
      throw std::logic_error(name + ": it has no binding " + b.name);
  if (n) context.push_descriptors(commands, point, layout, 0, n, writes);
}

void PassLayout::push(VkCommandBuffer commands, const void* data, std::size_t bytes) const {
  if (bytes != reflection.push_bytes)
    throw std::logic_error(name + ": its push constants are " + std::to_string(reflection.push_bytes) + " bytes, not " +
                           std::to_string(bytes));
  if (bytes) vkCmdPushConstants(commands, layout, stages_, 0, static_cast<std::uint32_t>(bytes), data);
}

Specialisation::Specialisation(const Constants& constants) {
  for (std::uint32_t i = 0; i < constants.size(); ++i) {
    std::uint32_t word = 0;
    std::visit([&](auto value) { std::memcpy(&word, &value, 4); }, constants[i]);
    words.push_back(word);
    entries.push_back({i, i * 4, 4});
  }
  info = {static_cast<std::uint32_t>(entries.size()), entries.data(), words.size() * 4, words.data()};
}

namespace {

VkPipeline make_pipeline(const PassLayout& layout, const Constants& constants) {
  const Specialisation specialisation(constants);
  VkComputePipelineCreateInfo info{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = layout.modules[0];
  info.stage.pName = "main";
  info.stage.pSpecializationInfo = &specialisation.info;
  info.layout = layout.layout;
  VkPipeline pipeline = VK_NULL_HANDLE;
  const VkResult result =
      vkCreateComputePipelines(layout.context.device(), layout.context.pipeline_cache(), 1, &info, nullptr, &pipeline);
  return named(layout, pipeline, result, "vkCreateComputePipelines");
}

}  // namespace

VkPipeline named(const PassLayout& layout, VkPipeline pipeline, VkResult result, const char* call) {
  check(result, layout.name + ": " + call);
  layout.context.name(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(pipeline), layout.name);
  return pipeline;
}

Pipeline::~Pipeline() noexcept {
  try {
    group_.wait();
  } catch (...) {  // whoever dispatched it has heard
  }
  vkDestroyPipeline(context_.device(), pipeline_, nullptr);
}

Pass::Pass(Context& context, const std::string& shader, const Constants& constants)
    : layout_(context, {shader}), pipeline_(context, [this, constants] { return make_pipeline(layout_, constants); }) {}

}  // namespace alabaster::gpu
