// The exit by a gather along the refracted view ray.
#ifndef ALABASTER_SHARED_GATHER_H
#define ALABASTER_SHARED_GATHER_H
#include "beam.h"

ALABASTER_BEGIN_SHARED

// Of the facet's hemisphere: rings of equal flux, directions a ring.
#define GATHER_RINGS 5
#define GATHER_SECTORS 4
// Optical depth at which a ray is deep enough.
#define GATHER_DEEP 5.0

// Of the light behind an object, what is worth a ray through it.
#define STRAIGHT_LEAST_SHARE 1e-4
// Threads of a workgroup that takes pixels off the list of those where there is such light.
#define OPEN_GROUP 64u

// Sides of facets, at most, that are asked what the gather sends out there.
#define GATHER_ASKED 8192
// Levels: their nodes are that many mean free paths apart, and at least so many cells.
#define GATHER_LEVEL_REACH 4.0
#define GATHER_LEAST_LEVEL_EDGE 8.0
// Entries of the closure's table, to this 1 - a' at most.
#define GATHER_CLOSURES 17
#define GATHER_MOST_ABSORBED 0.3
// Of what spreads light that was just scattered: its length squared, in mean free paths (SP3's 9/35).
#define GATHER_SPREAD (9.0f / 35.0f)
// Entries of its table of the outside cosine.
#define GATHER_EXITS 17

struct GatherGrid {
  ivec3 cells;
  int channels;      // 1 or 3
  vec3 origin;       // m
  float h;           // m
  vec3 kappa_scale;  // m
  float eta, A, f_dt;
  float skin;                     // h, at least
  float level_edge;               // h, between nodes of the levels
  vec2 closure[GATHER_CLOSURES];  // engine/shading/gather_closure.h
  float exit[GATHER_EXITS];
};

// Out of one side of a cut cell, times 4 / F_dt, W/m^2 h^2.
struct GatherFlux {
  vec3 wanted;    // by the diffusion equation
  vec3 gathered;  // by the gather, at level 1
};

// Some of the facets' sides: k * stride, k < count.
struct GatherLevelPush {
  uint count, stride;
};

// Half a sweep.
struct GatherSpreadPush {
  float leak;        // T that leaves by the surface, GatherClosures::leak()
  float relaxation;  // 1 to 2
  int colour;        // 0 or 1
};

struct GatherShiftPush {
  ivec3 cells;
  float kept;  // GatherClosures::kept()
};

struct GatherPicturePush {
  ivec3 cells;
  int count;  // of cut cells, entry 0 included
};

// Mean depth, in mean free paths, of what a beam of cosine mu scatters down to depth `bound` (in mean free paths).
SHARED_FN real near_mean_depth(real mu, real bound) { return bound * loss_place(bound / mu); }

// Integral of exp(-k z) over z from 0 to `end`.
SHARED_FN real decay_integral(real k, real end) {
  real x = k * end;
  return abs(x) < real(1e-3) ? end * (real(1) - real(0.5) * x) : (real(1) - exp(-x)) / k;
}

// Of exp(k z - tau): as it is where exp(k z) alone would overflow.
SHARED_FN real growth_integral(real k, real end, real tau) {
  real x = k * end;
  return abs(x) < real(1e-3) ? end * (real(1) + real(0.5) * x) * exp(-tau) : (exp(x - tau) - exp(-tau)) / k;
}

// Light near a facet, as a view ray sees it that starts there or ends there. Depths z below the facet in mean free
// paths.
struct NearLight {
  float flux;    // of what a beam scatters down to `skin`, W/m^2
  float cosine;  // of the beam, inside
  float skin;    // the ray meets what is deeper in the cells
  float bound;   // what is scattered down to here drives the boundary condition; skin at least
  float albedo;
  float view;  // cosine of the ray with the facet's normal, inside
  float tau;   // optical depth of all of the ray
};

// 4 pi times the radiance of that light, flux exp(-z / mu) / (mu (1 - exp(-skin / mu))), at the ray's other side: seen
// from the facet, and from within towards it.
SHARED_INLINE float near_single(NearLight n) {
  float seen = decay_integral(1.0f / n.cosine + 1.0f / n.view, min(n.skin, n.tau * n.view));
  return n.flux * seen / (n.view * decay_integral(1.0f / n.cosine, n.skin));
}
SHARED_INLINE float near_single_behind(NearLight n) {
  float seen = growth_integral(1.0f / n.view - 1.0f / n.cosine, min(n.skin, n.tau * n.view), n.tau);
  return n.flux * seen / (n.view * decay_integral(1.0f / n.cosine, n.skin));
}

// What the same beam scatters down to `bound`, W/m^2.
SHARED_INLINE float near_driving(NearLight n) {
  return n.flux * decay_integral(1.0f / n.cosine, n.bound) / decay_integral(1.0f / n.cosine, n.skin);
}

// And what the fluence that the boundary condition drives says too much near the surface, 3 a' m e^(-z / m) of the flux
// that drives it, m its mean depth. In a half space that is 3 a' mu^2 / (mu + mu_view).
SHARED_INLINE float near_surplus(NearLight n) {
  float m = near_mean_depth(n.cosine, n.bound);
  return near_driving(n) * 3.0f * n.albedo * m / n.view * decay_integral(1.0f / m + 1.0f / n.view, n.tau * n.view);
}
SHARED_INLINE float near_surplus_behind(NearLight n) {
  float m = near_mean_depth(n.cosine, n.bound);
  return near_driving(n) * 3.0f * n.albedo * m / n.view *
         growth_integral(1.0f / n.view - 1.0f / m, n.tau * n.view, n.tau);
}

ALABASTER_END_SHARED

#endif
