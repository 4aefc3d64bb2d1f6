// The Vulkan instance, device and queue, and the message counter of the validation layers. One Context a process is
// usual; it outlives everything made from it.
#pragma once

#include <vulkan/vulkan.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

namespace alabaster::gpu {

/// Vulkan said no: what() names the call or the resource, and the remedy where there is one.
struct DeviceError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Throws DeviceError naming `what` unless `result` is VK_SUCCESS.
void check(VkResult result, const std::string& what);

struct DeviceInfo {
  std::string name;
  std::string driver;
  std::string kind;  // "discrete GPU", "integrated GPU", "CPU", ...
  std::uint32_t api_version = 0;
  std::uint64_t heap_bytes = 0;  // largest device-local heap
  std::string unusable;          // why not; empty when the device has all that is needed
};

struct ContextOptions {
  std::string device;         // part of a device's name, any case; empty: the best one (GPU before CPU)
  bool validation = false;    // also on in debug builds and with ALABASTER_VALIDATION=1 in the environment
  bool presentation = false;  // ask for the swapchain extension and the surface extensions below
  std::vector<const char*> instance_extensions;
};

/// All Vulkan devices of this machine. Throws DeviceError where there is no Vulkan driver.
std::vector<DeviceInfo> list_devices();

class Context {
 public:
  explicit Context(const ContextOptions& options = {});
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  VkInstance instance() const { return instance_; }
  VkPhysicalDevice physical_device() const { return physical_device_; }
  VkDevice device() const { return device_; }
  VkQueue queue() const { return queue_; }
  std::uint32_t queue_family() const { return queue_family_; }
  VkCommandPool command_pool() const { return command_pool_; }
  VkPipelineCache pipeline_cache() const { return pipeline_cache_; }
  const DeviceInfo& info() const { return info_; }
  const VkPhysicalDeviceLimits& limits() const { return limits_; }
  bool validation() const { return messenger_ != VK_NULL_HANDLE; }

  /// Warnings and errors of the validation layers so far. Tests fail on any.
  std::vector<std::string> validation_messages() const;

  VkDeviceMemory allocate(const VkMemoryRequirements& needs, bool host_visible, const std::string& name);
  void release(VkDeviceMemory memory);
  /// Device memory held now and at most so far, bytes.
  std::uint64_t allocated_bytes() const { return allocated_; }
  std::uint64_t peak_bytes() const { return peak_; }

  /// Names an object for the validation layers and for graphics debuggers.
  void name(VkObjectType type, std::uint64_t handle, const std::string& name) const;

  /// Milliseconds on the device by stage name, summed over Commands::time() scopes since the last reset_timings().
  const std::map<std::string, double>& timings() const { return timings_; }
  void add_timing(const std::string& stage, double milliseconds) { timings_[stage] += milliseconds; }
  void reset_timings() { timings_.clear(); }

  PFN_vkCmdPushDescriptorSetKHR push_descriptors = nullptr;
  PFN_vkCmdBeginDebugUtilsLabelEXT begin_label = nullptr;
  PFN_vkCmdEndDebugUtilsLabelEXT end_label = nullptr;

 private:
  void create_device(bool presentation);
  static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                   VkDebugUtilsMessageTypeFlagsEXT type,
                                                   const VkDebugUtilsMessengerCallbackDataEXT* data, void* user);

  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_device_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  VkCommandPool command_pool_ = VK_NULL_HANDLE;
  VkPipelineCache pipeline_cache_ = VK_NULL_HANDLE;
  std::uint32_t queue_family_ = 0;
  DeviceInfo info_;
  VkPhysicalDeviceLimits limits_{};
  VkPhysicalDeviceMemoryProperties memory_{};
  PFN_vkSetDebugUtilsObjectNameEXT set_name_ = nullptr;
  mutable std::mutex messages_guard_;  // pipelines are made by several threads
  std::vector<std::string> messages_;
  std::map<VkDeviceMemory, std::uint64_t> allocations_;
  std::uint64_t allocated_ = 0, peak_ = 0;
  std::map<std::string, double> timings_;
};

}  // namespace alabaster::gpu
