#include <cstdio>

#include "commands.h"
#include "gpu/context.h"

namespace alabaster {

void add_devices(CLI::App& app) {
  app.add_subcommand("devices", "the Vulkan devices of this machine")->callback([] {
    for (const gpu::DeviceInfo& d : gpu::list_devices())
      std::printf("%s: %s, %s, Vulkan %u.%u.%u, %.1f GiB%s%s\n", d.name.c_str(), d.kind.c_str(), d.driver.c_str(),
                  VK_API_VERSION_MAJOR(d.api_version), VK_API_VERSION_MINOR(d.api_version),
                  VK_API_VERSION_PATCH(d.api_version), static_cast<double>(d.heap_bytes) / (1u << 30),
                  d.unusable.empty() ? "" : "; not usable: ", d.unusable.c_str());
  });
}

}  // namespace alabaster
