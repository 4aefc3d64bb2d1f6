#include "gpu/raster.h"

namespace alabaster::gpu {

namespace {

VkPipeline make_pipeline(const PassLayout& layout, const RasterOptions& options) {
  const Specialisation specialisation(options.constants);
  VkPipelineShaderStageCreateInfo stages[2]{};
  for (int i = 0; i < 2; ++i) {
    stages[i].sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    stages[i].stage = i == 0 ? VK_SHADER_STAGE_VERTEX_BIT : VK_SHADER_STAGE_FRAGMENT_BIT;
    stages[i].module = layout.modules[static_cast<std::size_t>(i)];
    stages[i].pName = "main";
    stages[i].pSpecializationInfo = &specialisation.info;
  }

  std::vector<VkVertexInputAttributeDescription> attributes;
  VkVertexInputBindingDescription binding{0, 0, VK_VERTEX_INPUT_RATE_VERTEX};
  for (VkFormat format : layout.reflection.vertex_inputs) {
    attributes.push_back({static_cast<std::uint32_t>(attributes.size()), 0, format, binding.stride});
    binding.stride += format == VK_FORMAT_R32_SFLOAT         ? 4u
                      : format == VK_FORMAT_R32G32_SFLOAT    ? 8u
                      : format == VK_FORMAT_R32G32B32_SFLOAT ? 12u
                                                             : 16u;
  }
  VkPipelineVertexInputStateCreateInfo input{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
  input.vertexBindingDescriptionCount = attributes.empty() ? 0 : 1;
  input.pVertexBindingDescriptions = &binding;
  input.vertexAttributeDescriptionCount = static_cast<std::uint32_t>(attributes.size());
  input.pVertexAttributeDescriptions = attributes.data();

  VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
  viewport.viewportCount = viewport.scissorCount = 1;
  VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
  raster.cullMode = options.cull;
  raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
  raster.lineWidth = 1;
  raster.depthBiasEnable = options.depth_bias != 0 || options.depth_slope_bias != 0;
  raster.depthBiasConstantFactor = options.depth_bias;
  raster.depthBiasSlopeFactor = options.depth_slope_bias;
  VkPipelineMultisampleStateCreateInfo samples{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
  samples.rasterizationSamples = options.samples;
  VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
  depth.depthTestEnable = depth.depthWriteEnable = options.depth != VK_FORMAT_UNDEFINED;
  depth.depthCompareOp = options.depth_compare;
  VkPipelineColorBlendAttachmentState opaque{};
  opaque.colorWriteMask =
      VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
  const std::vector<VkPipelineColorBlendAttachmentState> attachments(options.color.size(), opaque);
  VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
  blend.attachmentCount = static_cast<std::uint32_t>(attachments.size());
  blend.pAttachments = attachments.data();
  const VkDynamicState states[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
  dynamic.dynamicStateCount = 2;
  dynamic.pDynamicStates = states;

  VkPipelineRenderingCreateInfo rendering{VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO};
  rendering.colorAttachmentCount = static_cast<std::uint32_t>(options.color.size());
  rendering.pColorAttachmentFormats = options.color.data();
  rendering.depthAttachmentFormat = options.depth;
  VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
  info.pNext = &rendering;
  info.stageCount = 2;
  info.pStages = stages;
  info.pVertexInputState = &input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &samples;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.pDynamicState = &dynamic;
  info.layout = layout.layout;
  VkPipeline pipeline = VK_NULL_HANDLE;
  const VkResult result =
      vkCreateGraphicsPipelines(layout.context.device(), layout.context.pipeline_cache(), 1, &info, nullptr, &pipeline);
  return named(layout, pipeline, result, "vkCreateGraphicsPipelines");
}

}  // namespace

RasterPass::RasterPass(Context& context, const std::string& vertex, const std::string& fragment,
                       const RasterOptions& options)
    : layout_(context, {vertex, fragment}),
      pipeline_(context, [this, options] { return make_pipeline(layout_, options); }) {}

}  // namespace alabaster::gpu
