// The optics of a smooth dielectric surface and of the report's surface model, written once for GLSL and C++.
// Symbols as in Arbree, Walter, Bala, "Diffusion Formulation for Heterogeneous Subsurface Scattering" ("the report"):
//   eta = index inside / index outside; phi, fluence, W/m^2; gamma_s, reduced-intensity flux, W/m^2; kappa in metres.
#ifndef ALABASTER_SHARED_OPTICS_H
#define ALABASTER_SHARED_OPTICS_H
#include "language.h"

ALABASTER_BEGIN_SHARED

// Cosine of the refracted direction; 0 under total reflection. `n_ratio` = index on the far side / index on the near side.
SHARED_FN real refracted_cosine(real cos_i, real n_ratio) {
  real s2 = (real(1) - cos_i * cos_i) / (n_ratio * n_ratio);
  return s2 >= real(1) ? real(0) : sqrt(real(1) - s2);
}

// Unpolarised Fresnel reflectance of a beam whose cosine with the normal is cos_i in [0, 1].
SHARED_FN real fresnel_reflectance(real cos_i, real n_ratio) {
  if (n_ratio == real(1)) return real(0);
  real c = min(max(cos_i, real(0)), real(1));
  real t = refracted_cosine(c, n_ratio);
  if (t <= real(0)) return real(1);
  real s = (c - n_ratio * t) / (c + n_ratio * t);
  real p = (n_ratio * c - t) / (n_ratio * c + t);
  return real(0.5) * (s * s + p * p);
}

SHARED_FN real fresnel_transmittance(real cos_i, real n_ratio) { return real(1) - fresnel_reflectance(cos_i, n_ratio); }

// Mean reflectance of diffuse light, 2 * integral_0^1 F_r(mu) mu dmu, for light meeting a medium `n_ratio` times denser.
// Midpoint rule in mu = t^2, which removes the kink at grazing; for n_ratio < 1 by the exact identity
// 1 - F(1/n) = (1 - F(n)) / n^2 (conservation of etendue), which holds the critical angle for us.
SHARED_FN real diffuse_reflectance(real n_ratio) {
  if (n_ratio == real(1)) return real(0);
  real n = n_ratio > real(1) ? n_ratio : real(1) / n_ratio;
  const int steps = 512;
  real sum = real(0);
  for (int i = 0; i < steps; ++i) {
    real t = (real(i) + real(0.5)) / real(steps);
    sum += real(4) * t * t * t * fresnel_reflectance(t * t, n);
  }
  real dense = sum / real(steps);
  return n_ratio > real(1) ? dense : real(1) - (real(1) - dense) / (n * n);
}

// F_dr: mean internal reflectance of the surface of a medium with relative index eta (theory: eta 1.3 -> 0.4445).
SHARED_FN real internal_diffuse_reflectance(real eta) { return diffuse_reflectance(real(1) / eta); }

// A = (1 + F_dr) / (1 - F_dr), the report's Eq. 9.
SHARED_FN real boundary_constant(real f_dr) { return (real(1) + f_dr) / (real(1) - f_dr); }

// exp(-sigma_a / sigma_s'): share of the refracted light that reaches its first collision as a scattering one (Eq. 5,
// with sigma_s' for sigma_s). A medium that does not scatter passes nothing on; one that does nothing passes all.
SHARED_FN real reduced_intensity(real sigma_a, real sigma_s_reduced) {
  if (sigma_a <= real(0)) return real(1);
  if (sigma_s_reduced <= real(0)) return real(0);
  return exp(-sigma_a / sigma_s_reduced);
}

// Right-hand side of the DSBC (Eq. 11): phi + 2 A kappa d_n phi = 4 Gamma_s / F_dt.
SHARED_FN real dsbc_source(real gamma_s, real f_dt) { return real(4) * gamma_s / f_dt; }

// Conductance per area between the boundary value 4 Gamma_s / F_dt and an unknown at distance d below the surface: the
// DSBC's 2A and the medium's d / kappa in series.
SHARED_FN real dsbc_conductance(real A, real distance_over_kappa) { return real(1) / (real(2) * A + distance_over_kappa); }

// Fluence on the surface from the same series resistance: q = 4 Gamma_s / F_dt, phi at distance d below.
SHARED_FN real dsbc_surface_fluence(real phi, real q, real A, real distance_over_kappa) {
  return (real(2) * A * phi + distance_over_kappa * q) / (real(2) * A + distance_over_kappa);
}

// The bracket of the render query (Eq. 14), W/m^2. Negative where diffusion itself ends; the caller counts and clamps.
SHARED_FN real query_bracket(real phi, real gamma_s, real A, real f_dt) {
  return (real(1) + real(1) / A) * phi - real(4) * gamma_s / (f_dt * A);
}

// Radiance that leaves towards an outside direction with Fresnel transmittance f_t. `exit_scale` is 1 / eta^2, or 1 for
// the query as printed (`--transport as-printed`).
SHARED_FN real query_radiance(real bracket, real f_t, real exit_scale) {
  return f_t * exit_scale * bracket * real(0.07957747154594767);  // 1 / (4 pi)
}

// The directional source: a beam that enters a half space with cosine mu inside, solved by P1 with its volume source
//   -kappa phi'' + sigma_a phi = sigma_s' e^(-z sigma_t' / mu) / mu,  phi - 2 A kappa phi' = 0 at z = 0,
// and written as a source on the boundary plus a share that leaves where it entered. Lengths in 1 / sigma_t'; `absorbed` is
// 1 - a' = sigma_a / sigma_t'; s = 2 A kappa / l, l the diffusion length. Both are shares of the flux that entered.
// Below the first few mean free paths the fluence is the beam's own if phi + 2 A kappa d_n phi = 4 f / F_dt: f has a pole at
// kappa = sigma_a mu^2, where the beam decays like the diffuse light, and is bounded to 1.2 times its form without absorption.
SHARED_FN real directional_boundary(real mu, real absorbed, real A, real f_dt) {
  real decay = real(1) - real(3) * absorbed * mu * mu;
  real growth = decay * real(1.2) > real(1) - absorbed ? (real(1) - absorbed) / decay : real(1.2);
  return real(0.75) * f_dt * (mu + real(2) * A / real(3)) * growth;
}

// What P1 sends back of the beam, all told: rho = a' / ((1 + mu / l)(1 + s)).
SHARED_FN real directional_reflectance(real mu, real absorbed, real A) {
  real per_length = sqrt(real(3) * absorbed);  // 1 / l
  return (real(1) - absorbed) / ((real(1) + mu * per_length) * (real(1) + real(2) * A * per_length / real(3)));
}

// c = rho - f (1 - 2 s / (A F_dt (1 + s))): what leaves where it entered, so that a half space reflects rho. Without
// absorption c = 1 - f. May be negative.
SHARED_FN real directional_exit(real mu, real absorbed, real A, real f_dt) {
  real s = real(2) * A * sqrt(real(3) * absorbed) / real(3);
  return directional_reflectance(mu, absorbed, A) -
         directional_boundary(mu, absorbed, A, f_dt) * (real(1) - real(2) * s / (A * f_dt * (real(1) + s)));
}

// Flux that a boundary source gamma_s with the query's gamma_q brings into the object, W/m^2: the flux of the DSBC into the
// volume plus what the query says leaves. gamma_q = gamma_s in the report; with the shares above gamma_s = f E and
// gamma_q = f E - A c E, which is (f + c) E.
SHARED_FN real entering_flux(real gamma_s, real gamma_q, real A, real f_dt) {
  return (real(2) * gamma_s / f_dt - gamma_q) / A;
}

ALABASTER_END_SHARED

#endif
