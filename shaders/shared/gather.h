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

// 4 pi times the radiance at the surface, towards cosine mu_view inside, of the light scattered near a facet: its flux
// `near_flux` is spread as e^(-z / m) over depth (m its mean, in mean free paths) and seen through e^(-s); and less what the fluence
// that the boundary condition drives says too much near the surface, 3 a' m e^(-z / m) of that flux.
// With mu = m a half space then has (1 - 3 a' mu^2) / (mu + mu_view).
SHARED_FN real near_gather(real near_flux, real m, real albedo, real mu_view) {
  return near_flux * (real(1) - real(3) * albedo * m * m) / (m + mu_view);
}

ALABASTER_END_SHARED

#endif
