// Single scattering (P. Hanrahan, W. Krueger, "Reflection from Layered Surfaces due to Subsurface Scattering", 1993).
//
// Along the refracted view ray the source is sigma_s p(w', w) E, with E the light that comes straight through the surface:
//   L = F_t / eta^2 integral sigma_s p F_t(cos) (cos / mu') L_i e^(-tau_view - tau_light) ds;
// a half space of one medium has L = a p F_t F_t L_i cos / (mu' + mu'_view) / eta^2. A light's way to a point inside is taken
// straight, as Jensen et al. 2001 do, and its length as that of the refracted ray below the place where it meets the surface.
#ifndef ALABASTER_SHARED_SINGLE_H
#define ALABASTER_SHARED_SINGLE_H
#include "lighting.h"

ALABASTER_BEGIN_SHARED

// Optical depth beyond which nothing is looked for.
#define SINGLE_DEEP 8.0
// Places along the view ray where light is looked for, the first on the surface: in media that are the same everywhere, and
// in others. Between them the optical depth of the light's way is taken as linear, which is exact below a plane.
#define SINGLE_PLACES 4
#define SINGLE_PLACES_VARYING 8
// Lights in a dispatch: lavapipe ends an invocation after 65535 turns of its loops, all taken together.
#define SINGLE_LIGHTS 8
// Sides of facets, at most, that are asked what leaves there.
#define SINGLE_ASKED 8192
// Cosines of the table of SingleScattering, evenly spread in their square root.
#define SINGLE_TABLE 64

struct SingleGrid {
  ivec3 cells;
  int channels;      // 1 or 3
  vec3 origin;       // m
  float h;           // m
  vec3 kappa_scale;  // m
  float eta, A, f_dt, f_dt_outer;
  float g;
  uint object;       // in Scene::objects
  uint varies;       // 0: the coefficients below hold everywhere
  vec3 sigma_s, sigma_a;  // 1/m, not reduced
};

struct SingleFluxPush {
  uint sides;  // two an entry of Domain::cut_cells
  float eta, f_dt_outer;
  float A, f_dt;
  float g;
  SkyLinks sky;  // none: the lighting's directions
};

// Some of the facets' sides, each with one direction of its own: first + k * stride, k < count.
struct SingleLeavesPush {
  uint count, stride;
  uint first_light, end_light;
};

struct SingleScalePush {
  uint sides;
  vec3 scale;
};

// Henyey-Greenstein, 1/sr; `cosine` between the ways before and after.
SHARED_FN real henyey_greenstein(real g, real cosine) {
  real d = real(1) + g * g - real(2) * g * cosine;
  return real(0.07957747154594767) * (real(1) - g * g) / (d * sqrt(d));  // 1 / (4 pi)
}

// Mean of exp(-t) over t from a to b.
SHARED_FN real mean_exponential(real a, real b) {
  real x = b - a;
  if (abs(x) < real(1e-2)) return exp(-a) * (real(1) - x / real(2) + x * x / real(6));
  return (exp(-a) - exp(-b)) / x;
}

// sigma_s / sigma_t from kappa (m) and sigma_a, where sigma_s' = sigma_s (1 - g).
SHARED_FN real true_albedo(real kappa, real sigma_a, real g) {
  real sigma_s = max(real(1) / (real(3) * kappa) - sigma_a, real(0)) / (real(1) - g);
  return sigma_s + sigma_a > real(0) ? sigma_s / (sigma_s + sigma_a) : real(0);
}

// What a half space sends back of a boundary source Gamma_s by the report's boundary condition and query:
// R = (1 + 1/A) / (1 + s) - 1/A, s = 2 A kappa / l. Below 0 where diffusion ends.
SHARED_FN real boundary_source_reflectance(real kappa, real sigma_a, real A) {
  real s = real(2) * A * sqrt(kappa * sigma_a);
  return (real(1) + real(1) / A) / (real(1) + s) - real(1) / A;
}

// Gamma_s where `leaves` of it, W/m^2, comes out after one scattering.
SHARED_FN real gamma_beside_single(real gamma_s, real leaves, real kappa, real sigma_a, real A) {
  real reflectance = boundary_source_reflectance(kappa, sigma_a, A);
  return leaves < reflectance * gamma_s ? gamma_s - leaves / reflectance : real(0);
}

ALABASTER_END_SHARED

#endif
