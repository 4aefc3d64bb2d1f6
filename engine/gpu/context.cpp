#include "gpu/context.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vulkan/vulkan.hpp>

namespace alabaster::gpu {
namespace {

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";
constexpr const char* no_vulkan =
    "no Vulkan device: install a driver (Debian: mesa-vulkan-drivers has lavapipe, which needs no GPU)";

template <class F>
F instance_function(VkInstance instance, const char* name) {
  return reinterpret_cast<F>(vkGetInstanceProcAddr(instance, name));
}

std::string lower(std::string s) {
  std::transform(s.begin(), s.end(), s.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return s;
}

bool has_layer(const char* name) {
  std::uint32_t count = 0;
  vkEnumerateInstanceLayerProperties(&count, nullptr);
  std::vector<VkLayerProperties> layers(count);
  vkEnumerateInstanceLayerProperties(&count, layers.data());
  return std::any_of(layers.begin(), layers.end(), [&](auto& l) { return std::strcmp(l.layerName, name) == 0; });
}

bool has_device_extension(VkPhysicalDevice device, const char* name) {
  std::uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> all(count);
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, all.data());
  return std::any_of(all.begin(), all.end(), [&](auto& e) { return std::strcmp(e.extensionName, name) == 0; });
}

VkInstance create_instance(bool validation, std::vector<const char*> extensions) {
  VkApplicationInfo app{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  app.pApplicationName = "alabaster";
  app.apiVersion = VK_API_VERSION_1_3;
  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  info.pApplicationInfo = &app;
  // Synchronisation is the one mistake that lavapipe forgives and a GPU does not: check it too.
  const VkValidationFeatureEnableEXT extra[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = extra;
  if (validation) {
    if (!has_layer(validation_layer))
      throw DeviceError("Vulkan validation was asked for but its layer is missing: install vulkan-validationlayers");
    extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    info.pNext = &features;
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &validation_layer;
  }
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  VkInstance instance = VK_NULL_HANDLE;
  if (VkResult r = vkCreateInstance(&info, nullptr, &instance); r == VK_ERROR_INCOMPATIBLE_DRIVER)
    throw DeviceError(no_vulkan);
  else
    check(r, "vkCreateInstance");
  return instance;
}

std::vector<VkPhysicalDevice> physical_devices(VkInstance instance) {
  std::uint32_t count = 0;
  vkEnumeratePhysicalDevices(instance, &count, nullptr);
  std::vector<VkPhysicalDevice> devices(count);
  vkEnumeratePhysicalDevices(instance, &count, devices.data());
  return devices;
}

struct Features {
  VkPhysicalDeviceVulkan13Features v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  VkPhysicalDeviceVulkan12Features v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
  VkPhysicalDeviceFeatures2 all{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2};
  Features() {
    all.pNext = &v12;
    v12.pNext = &v13;
  }
};

const char* kind_name(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return "discrete GPU";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return "integrated GPU";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return "virtual GPU";
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return "CPU";
    default:
      return "other";
  }
}

DeviceInfo describe(VkPhysicalDevice device) {
  VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
  properties.pNext = &driver;
  vkGetPhysicalDeviceProperties2(device, &properties);
  DeviceInfo info;
  info.name = properties.properties.deviceName;
  info.driver = std::string(driver.driverName) + " " + driver.driverInfo;
  info.kind = kind_name(properties.properties.deviceType);
  info.api_version = properties.properties.apiVersion;
  VkPhysicalDeviceMemoryProperties memory;
  vkGetPhysicalDeviceMemoryProperties(device, &memory);
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    if (memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)
      info.heap_bytes = std::max<std::uint64_t>(info.heap_bytes, memory.memoryHeaps[i].size);
  if (info.api_version < VK_API_VERSION_1_3) {
    info.unusable = "Vulkan 1.3 is needed";
    return info;
  }
  Features f;
  vkGetPhysicalDeviceFeatures2(device, &f.all);
  if (!has_device_extension(device, VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME))
    info.unusable = "VK_KHR_push_descriptor is needed";
  if (!f.v13.dynamicRendering || !f.v13.synchronization2)
    info.unusable = "dynamic rendering and synchronization2 are needed";
  if (!f.v12.scalarBlockLayout) info.unusable = "scalarBlockLayout is needed";
  return info;
}

int preference(const DeviceInfo& info) {
  if (info.kind == "discrete GPU") return 3;
  if (info.kind == "integrated GPU") return 2;
  return info.kind == "CPU" ? 1 : 0;
}

}  // namespace

void check(VkResult result, const std::string& what) {
  if (result == VK_SUCCESS) return;
  std::string text = what + ": " + vk::to_string(vk::Result(result));
  if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY)
    text += "; choose a smaller --grid or --size";
  throw DeviceError(text);
}

std::vector<DeviceInfo> list_devices() {
  VkInstance instance = create_instance(false, {});
  std::vector<DeviceInfo> infos;
  for (VkPhysicalDevice device : physical_devices(instance)) infos.push_back(describe(device));
  vkDestroyInstance(instance, nullptr);
  if (infos.empty()) throw DeviceError(no_vulkan);
  return infos;
}

Context::Context(const ContextOptions& options) {
  const char* wish = std::getenv("ALABASTER_VALIDATION");
#ifdef NDEBUG
  constexpr bool debug = false;
#else
  const bool debug = has_layer(validation_layer);
#endif
  const bool validate = options.validation || debug || (wish && std::strcmp(wish, "1") == 0);
  instance_ = create_instance(validate, options.instance_extensions);
  if (validate) {
    VkDebugUtilsMessengerCreateInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
    info.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT;
    info.pfnUserCallback = on_message;
    info.pUserData = this;
    auto create = instance_function<PFN_vkCreateDebugUtilsMessengerEXT>(instance_, "vkCreateDebugUtilsMessengerEXT");
    check(create(instance_, &info, nullptr, &messenger_), "vkCreateDebugUtilsMessengerEXT");
  }

  int best = -1;
  std::string seen;
  for (VkPhysicalDevice candidate : physical_devices(instance_)) {
    DeviceInfo info = describe(candidate);
    seen += (seen.empty() ? "" : ", ") + info.name + (info.unusable.empty() ? "" : " (" + info.unusable + ")");
    const bool wanted = options.device.empty() || lower(info.name).find(lower(options.device)) != std::string::npos;
    if (!wanted || !info.unusable.empty() || preference(info) <= best) continue;
    best = preference(info);
    physical_device_ = candidate;
    info_ = info;
  }
  if (seen.empty()) throw DeviceError(no_vulkan);
  if (best < 0) {
    const std::string asked = options.device.empty() ? std::string("no usable Vulkan device")
                                                     : "--device " + options.device + ": no such usable Vulkan device";
    throw DeviceError(asked + "; there are: " + seen);
  }
  create_device(options.presentation);
}

void Context::create_device(bool presentation) {
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(physical_device_, &properties);
  limits_ = properties.limits;
  vkGetPhysicalDeviceMemoryProperties(physical_device_, &memory_);

  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical_device_, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(physical_device_, &count, families.data());
  const VkQueueFlags needed = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  queue_family_ = count;
  for (std::uint32_t i = count; i-- > 0;)
    if ((families[i].queueFlags & needed) == needed) queue_family_ = i;
  if (queue_family_ == count) throw DeviceError(info_.name + ": no queue does both graphics and compute");

  const float priority = 1;
  VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
  queue.queueFamilyIndex = queue_family_;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;

  Features has, want;
  vkGetPhysicalDeviceFeatures2(physical_device_, &has.all);
  want.v13.dynamicRendering = want.v13.synchronization2 = want.v13.maintenance4 = VK_TRUE;
  // Stencils read one cell past the grid; robustness makes those reads zero instead of undefined.
  want.v13.robustImageAccess = has.v13.robustImageAccess;
  want.all.features.robustBufferAccess = has.all.features.robustBufferAccess;
  want.all.features.independentBlend = has.all.features.independentBlend;
  want.all.features.fragmentStoresAndAtomics = has.all.features.fragmentStoresAndAtomics;
  want.all.features.geometryShader = has.all.features.geometryShader;  // gl_PrimitiveID in fragment shaders
  want.all.features.shaderInt64 = has.all.features.shaderInt64;
  want.v12.scalarBlockLayout = VK_TRUE;
  want.v12.shaderBufferInt64Atomics = has.v12.shaderBufferInt64Atomics;
  want.v12.hostQueryReset = has.v12.hostQueryReset;

  std::vector<const char*> extensions{VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME};
  if (presentation) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
  VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
  info.pNext = &want.all;
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  check(vkCreateDevice(physical_device_, &info, nullptr, &device_), info_.name + ": vkCreateDevice");
  vkGetDeviceQueue(device_, queue_family_, 0, &queue_);

  VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  pool.queueFamilyIndex = queue_family_;
  check(vkCreateCommandPool(device_, &pool, nullptr, &command_pool_), "vkCreateCommandPool");
  VkPipelineCacheCreateInfo cache{VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
  check(vkCreatePipelineCache(device_, &cache, nullptr, &pipeline_cache_), "vkCreatePipelineCache");

  push_descriptors =
      reinterpret_cast<PFN_vkCmdPushDescriptorSetKHR>(vkGetDeviceProcAddr(device_, "vkCmdPushDescriptorSetKHR"));
  if (messenger_) {
    set_name_ = instance_function<PFN_vkSetDebugUtilsObjectNameEXT>(instance_, "vkSetDebugUtilsObjectNameEXT");
    begin_label = instance_function<PFN_vkCmdBeginDebugUtilsLabelEXT>(instance_, "vkCmdBeginDebugUtilsLabelEXT");
    end_label = instance_function<PFN_vkCmdEndDebugUtilsLabelEXT>(instance_, "vkCmdEndDebugUtilsLabelEXT");
  }
}

Context::~Context() {
  if (device_) {
    vkDeviceWaitIdle(device_);
    vkDestroyPipelineCache(device_, pipeline_cache_, nullptr);
    vkDestroyCommandPool(device_, command_pool_, nullptr);
    vkDestroyDevice(device_, nullptr);
  }
  if (messenger_)
    instance_function<PFN_vkDestroyDebugUtilsMessengerEXT>(instance_, "vkDestroyDebugUtilsMessengerEXT")(
        instance_, messenger_, nullptr);
  if (instance_) vkDestroyInstance(instance_, nullptr);
}

std::vector<std::string> Context::validation_messages() const {
  const std::lock_guard lock(messages_guard_);
  return messages_;
}

VkDeviceMemory Context::allocate(const VkMemoryRequirements& needs, bool host_visible, const std::string& name) {
  const VkMemoryPropertyFlags host = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  const VkMemoryPropertyFlags local = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
  const VkMemoryPropertyFlags wish = host_visible ? host : local;
  std::uint32_t type = memory_.memoryTypeCount;
  for (std::uint32_t i = memory_.memoryTypeCount; i-- > 0;)
    if ((needs.memoryTypeBits >> i & 1u) && (memory_.memoryTypes[i].propertyFlags & wish) == wish) type = i;
  if (type == memory_.memoryTypeCount) throw DeviceError(name + ": the device has no memory of the kind it needs");
  VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
  info.allocationSize = needs.size;
  info.memoryTypeIndex = type;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  check(vkAllocateMemory(device_, &info, nullptr, &memory), name + ": " + std::to_string(needs.size >> 20) + " MiB");
  allocations_[memory] = needs.size;
  allocated_ += needs.size;
  peak_ = std::max(peak_, allocated_);
  return memory;
}

void Context::release(VkDeviceMemory memory) {
  if (auto it = allocations_.find(memory); it != allocations_.end()) {
    allocated_ -= it->second;
    allocations_.erase(it);
  }
  vkFreeMemory(device_, memory, nullptr);
}

void Context::name(VkObjectType type, std::uint64_t handle, const std::string& name) const {
  if (!set_name_) return;
  VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT};
  info.objectType = type;
  info.objectHandle = handle;
  info.pObjectName = name.c_str();
  set_name_(device_, &info);
}

VKAPI_ATTR VkBool32 VKAPI_CALL Context::on_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                                   VkDebugUtilsMessageTypeFlagsEXT,
                                                   const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  std::fprintf(stderr, "vulkan: %s\n", data->pMessage);
  Context& context = *static_cast<Context*>(user);
  const std::lock_guard lock(context.messages_guard_);
  context.messages_.emplace_back(data->pMessage);
  return VK_FALSE;
}

}  // namespace alabaster::gpu
