// Procedural solids: what share each of a solid's parts has at a point. Written once for GLSL and C++, and evaluated
// from here by the renderer, the path tracer and any shader. A solid is a mixture of up to three parts whose shares are
// never negative and add up to 1, so its coefficients are at most those of the part that has most.
#ifndef ALABASTER_SHARED_PROCEDURAL_H
#define ALABASTER_SHARED_PROCEDURAL_H
#include "language.h"

#ifdef __cplusplus
namespace alabaster {
using std::cos, std::floor, std::sin;
}
#define SHARED_PLAIN inline
#else
#define SHARED_PLAIN
#endif

ALABASTER_BEGIN_SHARED

const uint solid_marble = 0;   // white stone, veins
const uint solid_jade = 1;     // light and dark stone in clouds, drawn out along y
const uint solid_wax = 2;      // two waxes, hardly mixed
const uint solid_wood = 3;     // early wood, late wood: rings around y
const uint solid_agate = 4;    // clear and milky bands around the origin
const uint solid_checker = 5;  // cubes of edge 1
const uint solid_skin = 6;     // layers by depth below the surface: epidermis, dermis, fat
const uint solid_kinds = 7;

struct SolidPart {
  vec3 sigma_s;  // 1/m
  vec3 sigma_a;  // 1/m
};

// Lengths but `depths` are in units of the pattern.
struct ProceduralSolid {
  uint kind;         // solid_*
  uint seed;         // of the noise
  float turbulence;  // how far noise bends the pattern; 1 is usual
  float sharpness;   // of what divides its parts; 1 is usual
  vec2 depths;       // m, skin: where the second and the third part begin
  SolidPart parts[3];
};

// 0..1, the same for the same lattice point.
SHARED_PLAIN uint lattice_hash(int x, int y, int z, uint seed) {
  uint h = uint(x) * 0x8da6b343u ^ uint(y) * 0xd8163841u ^ uint(z) * 0xcb1ab31fu ^ seed * 0x9e3779b9u;
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  h = (h ^ (h >> 12)) * 0x297a2d39u;
  return h ^ (h >> 15);
}

// From 0 at `low` to 1 at `high`, smooth at both.
SHARED_FN real smooth_rise(real low, real high, real x) {
  real t = min(max((x - low) / (high - low), real(0)), real(1));
  return t * t * (real(3) - real(2) * t);
}

// Smooth noise in -1..1 with features of length 1.
SHARED_FN real value_noise(real x, real y, real z, uint seed) {
  real low_x = floor(x);
  real low_y = floor(y);
  real low_z = floor(z);
  real u = smooth_rise(real(0), real(1), x - low_x);
  real v = smooth_rise(real(0), real(1), y - low_y);
  real w = smooth_rise(real(0), real(1), z - low_z);
  real sum = real(0);
  for (int corner = 0; corner < 8; ++corner) {
    int i = corner & 1;
    int j = (corner >> 1) & 1;
    int k = corner >> 2;
    real weight = (i == 1 ? u : real(1) - u) * (j == 1 ? v : real(1) - v) * (k == 1 ? w : real(1) - w);
    sum += weight * real(lattice_hash(int(low_x) + i, int(low_y) + j, int(low_z) + k, seed));
  }
  return sum * real(2.0 / 4294967296.0) - real(1);
}

// Four octaves of noise, in -1.875..1.875.
SHARED_FN real turbulence(real x, real y, real z, uint seed) {
  real sum = real(0);
  real amplitude = real(1);
  for (int octave = 0; octave < 4; ++octave) {
    sum += amplitude * value_noise(x, y, z, seed);
    amplitude *= real(0.5);
    x = real(2) * x + real(17.3);
    y = real(2) * y + real(17.3);
    z = real(2) * z + real(17.3);
  }
  return sum;
}

// 1 in the middle of a vein, 0 far from one: the zero level of a bent wave.
SHARED_FN real vein(real wave, real narrowness) { return exp(-narrowness * wave * wave); }

SHARED_FN real marble_share(real x, real y, real z, uint seed, real bending, real sharpness) {
  real bend = turbulence(real(1.7) * x, real(1.7) * y, real(1.7) * z, seed);
  real fine_bend = turbulence(real(2.6) * x + real(31), real(2.6) * y + real(31), real(2.6) * z + real(31), seed);
  real broad_wave = real(8) * (real(0.62) * x + real(0.7) * y + real(0.35) * z) + real(3) * bending * bend;
  real thin_wave = real(11) * (real(-0.5) * x + real(0.75) * y + real(0.45) * z) + real(4) * bending * fine_bend;
  real fading =
      real(0.6) + real(0.4) * value_noise(real(3) * x + real(40), real(3) * y + real(40), real(3) * z + real(40), seed);
  real share =
      fading * vein(sin(broad_wave), real(22) * sharpness) + real(0.5) * vein(sin(thin_wave), real(60) * sharpness);
  return min(share, real(1));
}

// A rise around the middle, over a width of 1 / sharpness.
SHARED_FN real cloud(real level, real sharpness) {
  return smooth_rise(real(-0.5) / sharpness, real(0.5) / sharpness, level);
}

SHARED_FN real jade_share(real x, real y, real z, uint seed, real bending, real sharpness) {
  real bend = bending * value_noise(real(2) * x + real(9), real(2) * y + real(9), real(2) * z + real(9), seed);
  real level = turbulence(real(4) * x + bend, real(1.6) * y, real(4) * z - bend, seed);
  return cloud(real(0.7) * level, sharpness);
}

SHARED_FN real wax_share(real x, real y, real z, uint seed, real bending, real sharpness) {
  real level = real(0.35) * bending * turbulence(real(2.5) * x, real(2.5) * y, real(2.5) * z, seed);
  return cloud(level, real(0.5) * sharpness);
}

// Late wood comes slowly towards the end of a year's ring, which then breaks off.
SHARED_FN real wood_share(real x, real y, real z, uint seed, real bending, real sharpness) {
  real bend = real(0.6) * bending * value_noise(real(2.2) * x, real(0.4) * y, real(2.2) * z, seed) +
              real(0.12) * bending * value_noise(real(9) * x, real(0.7) * y, real(9) * z, seed);
  real ring = real(10) * sqrt(x * x + z * z) + bend;
  real year = ring - floor(ring);
  return smooth_rise(real(0.25), real(0.85), year) *
         (real(1) - smooth_rise(real(1) - real(0.1) / sharpness, real(1), year));
}

SHARED_FN real agate_share(real x, real y, real z, uint seed, real bending, real sharpness) {
  real bend = real(0.12) * bending * turbulence(real(2) * x, real(2) * y, real(2) * z, seed);
  real distance = sqrt(x * x + y * y + z * z) + bend;
  real wave = sin(real(50) * distance) + real(0.6) * sin(real(21) * distance + real(1));
  return cloud(real(0.5) * wave, sharpness);
}

SHARED_FN real checker_share(real x, real y, real z) {
  return real((int(floor(x)) + int(floor(y)) + int(floor(z))) & 1);
}

// Share of part 1 or 2 (part 0 has what they leave) at (x, y, z), in units of the pattern, `depth` m below the surface
// (skin only).
SHARED_FN real solid_share(uint kind, uint seed, real bending, real sharpness, real first, real second, uint part,
                           real x, real y, real z, real depth) {
  if (kind == solid_skin) {
    // Layers blend over a quarter of their depth to both sides, less where `sharpness` says so.
    real blend = real(0.25) / sharpness;
    real below_second = smooth_rise(second * (real(1) - blend), second * (real(1) + blend), depth);
    if (part == 2) return below_second;
    return smooth_rise(first * (real(1) - blend), first * (real(1) + blend), depth) * (real(1) - below_second);
  }
  if (part == 2) return real(0);
  if (kind == solid_marble) return marble_share(x, y, z, seed, bending, sharpness);
  if (kind == solid_jade) return jade_share(x, y, z, seed, bending, sharpness);
  if (kind == solid_wax) return wax_share(x, y, z, seed, bending, sharpness);
  if (kind == solid_wood) return wood_share(x, y, z, seed, bending, sharpness);
  if (kind == solid_agate) return agate_share(x, y, z, seed, bending, sharpness);
  return checker_share(x, y, z);
}

ALABASTER_END_SHARED

#endif
