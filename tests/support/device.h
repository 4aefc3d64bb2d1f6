// One validated device a test process. Any validation message fails the test that caused it.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>

#include "gpu/commands.h"

namespace alabaster {

/// Lavapipe by default, so that results do not depend on the machine; ALABASTER_DEVICE names another.
inline gpu::Context& test_context() {
  static gpu::Context context([] {
    const char* device = std::getenv("ALABASTER_DEVICE");
    gpu::ContextOptions options;
    options.device = device ? device : "llvmpipe";
    options.validation = true;
    return options;
  }());
  return context;
}

class GpuTest : public ::testing::Test {
 protected:
  gpu::Context& context = test_context();
  void TearDown() override {
    for (std::size_t i = seen_; i < context.validation_messages().size(); ++i)
      ADD_FAILURE() << context.validation_messages()[i];
  }

 private:
  std::size_t seen_ = context.validation_messages().size();
};

}  // namespace alabaster
