// The exit by a gather along the refracted view ray.
#ifndef ALABASTER_SHARED_GATHER_H
#define ALABASTER_SHARED_GATHER_H
#include "beam.h"

ALABASTER_BEGIN_SHARED

// Of the facet's hemisphere: rings of equal flux, directions a ring.
#define GATHER_RINGS 3
#define GATHER_SECTORS 4
// Optical depth at which a ray is deep enough.
#define GATHER_DEEP 5.0

// A facet's level is held between these; how many sides there are and how many it is held on.
#define GATHER_LEAST_LEVEL 0.5
#define GATHER_MOST_LEVEL 2.0
#define GATHER_SIDES 0
#define GATHER_BOUNDED 1

struct GatherGrid {
  ivec3 cells;
  int channels;      // 1 or 3
  vec3 origin;       // m
  float h;           // m
  vec3 kappa_scale;  // m
  float eta, A, f_dt;
};

struct GatherPicturePush {
  ivec3 cells;
  int count;  // of cut cells, entry 0 included
};

// Mean depth, in mean free paths, of what a beam of cosine mu scatters down to depth `bound` (in mean free paths).
SHARED_FN real near_mean_depth(real mu, real bound) { return bound * loss_place(bound / mu); }

// 4 pi times the radiance at the surface, towards cosine mu_view inside, of the light that a beam of cosine mu scatters down to
// depth `bound` (mean free paths); `near_flux` is all of it.
SHARED_FN real near_single(real near_flux, real mu, real bound, real mu_view) {
  real x = bound / mu, y = bound * (real(1) / mu + real(1) / mu_view);
  real scattered = x < real(1e-3) ? x * (real(1) - real(0.5) * x) : real(1) - exp(-x);
  real seen = y < real(1e-3) ? y * (real(1) - real(0.5) * y) : real(1) - exp(-y);
  return near_flux * seen / (scattered * (mu + mu_view));
}

// And what the fluence that the boundary condition drives says too much near the surface, 3 a' m e^(-z / m) of that flux, m its
// mean depth. In a half space that is 3 a' mu^2 / (mu + mu_view).
SHARED_FN real near_surplus(real near_flux, real m, real albedo, real mu_view) {
  return near_flux * real(3) * albedo * m * m / (m + mu_view);
}

ALABASTER_END_SHARED

#endif
