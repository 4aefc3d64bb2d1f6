#include "sweep.h"

namespace alabaster {

void plain_sweep(const PlainSystem& s, float omega, const float* from, float* to) {
  const std::ptrdiff_t up_y = s.n + 2, up_z = up_y * up_y;
#pragma omp parallel for
  for (int z = 1; z <= s.n; ++z)
    for (int y = 1; y <= s.n; ++y) {
      const std::ptrdiff_t row = y * up_y + z * up_z;
#pragma omp simd
      for (std::ptrdiff_t i = row + 1; i <= row + s.n; ++i) {
        const float own = from[i];
        float product = s.reaction[i] * own;
        product += s.face_x[i] * (own - from[i - 1]) + s.face_x[i + 1] * (own - from[i + 1]);
        product += s.face_y[i] * (own - from[i - up_y]) + s.face_y[i + up_y] * (own - from[i + up_y]);
        product += s.face_z[i] * (own - from[i - up_z]) + s.face_z[i + up_z] * (own - from[i + up_z]);
        to[i] = own + omega * s.inverse_l1[i] * (s.b[i] - product);
      }
    }
}

void plain_copy(const float* from, float* to, std::size_t count) {
#pragma omp parallel for simd
  for (std::size_t i = 0; i < count; ++i) to[i] = from[i];
}

}  // namespace alabaster
