#include "scene/marble.h"

#include <cmath>

#include "scene/presets.h"
#include "scene/shapes.h"

namespace alabaster {
namespace {

/// 0..1, the same for the same lattice point.
double lattice_noise(glm::ivec3 p) {
  std::uint32_t h =
      std::uint32_t(p.x) * 0x8da6b343u ^ std::uint32_t(p.y) * 0xd8163841u ^ std::uint32_t(p.z) * 0xcb1ab31fu;
  h = (h ^ h >> 15) * 0x2c1b3c6du;
  h = (h ^ h >> 12) * 0x297a2d39u;
  h ^= h >> 15;
  return h / 4294967295.0;
}

/// Smooth noise in -1..1 with features of length 1.
double value_noise(glm::dvec3 p) {
  glm::ivec3 cell(glm::floor(p));
  glm::dvec3 f = p - glm::dvec3(cell);
  glm::dvec3 s = f * f * (3.0 - 2.0 * f);
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    glm::ivec3 step(corner & 1, corner >> 1 & 1, corner >> 2);
    double weight = 1;
    for (int axis = 0; axis < 3; ++axis) weight *= step[axis] ? s[axis] : 1 - s[axis];
    sum += weight * lattice_noise(cell + step);
  }
  return 2 * sum - 1;
}

double turbulence(glm::dvec3 p) {
  double sum = 0, amplitude = 1;
  for (int octave = 0; octave < 4; ++octave, amplitude *= 0.5, p = 2.0 * p + 17.3) sum += amplitude * value_noise(p);
  return sum;
}

/// 1 in the middle of a vein, 0 far from one: the zero level of a bent wave. `sharpness` narrows it.
double vein(double wave, double sharpness) { return std::exp(-sharpness * wave * wave); }

/// How much of the vein's matter there is, 0..1. `p`: position in units of the box.
double veins(glm::dvec3 p) {
  double bend = turbulence(1.7 * p), fine_bend = turbulence(2.6 * p + 31.0);
  double broad = vein(std::sin(8 * glm::dot(p, glm::dvec3(0.62, 0.7, 0.35)) + 3.0 * bend), 22);
  double thin = vein(std::sin(11 * glm::dot(p, glm::dvec3(-0.5, 0.75, 0.45)) + 4.0 * fine_bend), 60);
  double fading = 0.6 + 0.4 * value_noise(3.0 * p + 40.0);
  return std::min(1.0, fading * broad + 0.5 * thin);
}

}  // namespace

Medium veined_marble(const Bounds& bounds, int cells) {
  const Coefficients white = preset("marble")->coefficients;
  auto sigma_t = std::make_shared<Grid>(Grid{glm::ivec3(cells), 3, {}});
  auto albedo = std::make_shared<Grid>(Grid{glm::ivec3(cells), 3, {}});
  for (int z = 0; z < cells; ++z)
    for (int y = 0; y < cells; ++y)
      for (int x = 0; x < cells; ++x) {
        double v = veins((glm::dvec3(x, y, z) + 0.5) / double(cells));
        glm::dvec3 sigma_a = white.sigma_a * (1 + 59 * v) * (1.0 + v * glm::dvec3(0, 0.15, 0.3));
        glm::dvec3 sigma_s = white.sigma_s * (1 - 0.4 * v);
        for (int c = 0; c < 3; ++c) {
          sigma_t->values.push_back(float(sigma_s[c] + sigma_a[c]));
          albedo->values.push_back(float(sigma_s[c] / (sigma_s[c] + sigma_a[c])));
        }
      }
  Medium medium;
  medium.sigma_t = sigma_t;
  medium.albedo = albedo;
  medium.world_to_box = glm::inverse(translation(bounds.low) * scaling(bounds.size()));
  return medium;
}

}  // namespace alabaster
