// Pictures for tests.
#pragma once

#include "image/picture.h"

namespace alabaster {

inline Picture constant(int width, int height, float value) {
  Picture picture{width, height, {}, {}};
  for (const char* c : {"R", "G", "B"}) picture.plane(c).assign(static_cast<std::size_t>(width * height), value);
  return picture;
}

}  // namespace alabaster
