// Random numbers and the phase function of the path tracer.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace alabaster {

constexpr float pi = 3.14159265358979f;

/// PCG32 (M. O'Neill, "PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms for Random Number
/// Generation", 2014), one stream for each (seed, pixel, sample): what a path sees depends on nothing else, so a
/// picture does not depend on threads, order or interruptions.
class Random {
 public:
  Random(std::uint64_t seed, std::uint64_t pixel, std::uint64_t sample) {
    const std::uint64_t key = mix(mix(mix(seed + 0x9e3779b97f4a7c15u) + pixel) + sample);
    increment_ = (mix(key ^ 0xd1b54a32d192ed03u) << 1) | 1u;
    state_ = key + increment_;
    bits();
  }
  std::uint32_t bits() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005u + increment_;
    const auto shifted = static_cast<std::uint32_t>(((old >> 18) ^ old) >> 27);
    const auto turn = static_cast<std::uint32_t>(old >> 59);
    return (shifted >> turn) | (shifted << ((32u - turn) & 31u));
  }
  /// In [0, 1), 24 bits.
  float uniform() { return static_cast<float>(bits() >> 8) * 0x1p-24f; }
  /// Exponential with mean 1; offset by half a step so that it is never 0.
  float exponential() { return -std::log((static_cast<float>(bits() >> 8) + 0.5f) * 0x1p-24f); }

 private:
  static std::uint64_t mix(std::uint64_t x) {  // splitmix64's finaliser
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
  }
  std::uint64_t state_ = 0, increment_ = 1;
};

/// The direction with z = `c` and azimuth 2 pi u.
inline glm::vec3 from_axis(float c, float u) {
  const float r = std::sqrt(std::max(0.0f, 1.0f - c * c)), turn = 2 * pi * u;
  return {r * std::cos(turn), r * std::sin(turn), c};
}

/// The direction with polar cosine `c` about `axis` (unit) and azimuth 2 pi u.
inline glm::vec3 around(glm::vec3 axis, float c, float u) {
  // Orthonormal basis without a branch on degenerate axes: Duff et al., JCGT 6(1), 2017.
  const float sign = std::copysign(1.0f, axis.z), a = -1.0f / (sign + axis.z), b = axis.x * axis.y * a;
  const glm::vec3 s{1.0f + sign * axis.x * axis.x * a, sign * b, -sign * axis.x};
  const glm::vec3 t{b, sign + axis.y * axis.y * a, -axis.y};
  const float r = std::sqrt(std::max(0.0f, 1.0f - c * c)), turn = 2 * pi * u;
  const glm::vec3 d = r * std::cos(turn) * s + r * std::sin(turn) * t + c * axis;
  return d * (1.5f - 0.5f * glm::dot(d, d));  // one Newton step keeps thousands of turns at unit length
}

/// Henyey-Greenstein phase function of the cosine between the directions before and after, 1/sr; its integral over the
/// sphere is 1.
inline float phase_value(float g, float cosine) {
  // 1 + g^2 - 2 g cosine without its cancellation at the peak
  const float d =
      (1.0f - std::abs(g)) * (1.0f - std::abs(g)) + 2.0f * std::abs(g) * (1.0f - std::copysign(1.0f, g) * cosine);
  return (1.0f - g * g) / (4.0f * pi * d * std::sqrt(d));
}

/// A cosine distributed as phase_value; mean cosine g.
inline float phase_cosine(float g, float u) {
  // Near g = 0 the closed form cancels; its first order in g has an error of g^2.
  if (std::abs(g) < 1e-3f) return 2.0f * u - 1.0f + 6.0f * g * u * (1.0f - u);
  const float s = (1.0f - g * g) / (1.0f - g + 2.0f * g * u);
  return std::min(1.0f, std::max(-1.0f, (1.0f + g * g - s * s) / (2.0f * g)));
}

}  // namespace alabaster
