// The volume source: refracted light samples marched from their facets through the cells. Counted in whole units of
// power (64 bits as two words), so that the order of the additions does not show and nothing is lost.
#ifndef ALABASTER_SHARED_BEAM_H
#define ALABASTER_SHARED_BEAM_H
#include "lighting.h"
#include "optics.h"

ALABASTER_BEGIN_SHARED

// Most units that one beam starts with: whole numbers up to here are exact in single precision.
#define BEAM_MOST_UNITS 16777216.0
// Lavapipe ends an invocation after 65535 turns of its loops, all taken together: a step through a cell takes some
// twenty, and a beam at most BEAM_MOST_STEPS times as many steps as the grid has cells along its three edges together.
#define BEAM_MOST_STEPS 4
#define BEAM_TURNS_A_STEP 30
#define BEAM_MOST_TURNS 65000
// A beam with less than 1 / this of its units left in every channel is laid down where it is (7 mean free paths).
#define BEAM_LEAST_SHARE 1024u
#define BEAM_MOST_REFLECTIONS 4
// Directions in which a facet sees other surfaces that go as one beam: those that follow each other have cosines that
// are alike.
#define BEAM_SURFACE_GROUP 3
// Places of the mesh in one facet that beams start from.
#define BEAM_MOST_STARTS 4

// Depths below a facet, h, or less where the object is thinner. What is scattered nearer than this drives the boundary
// condition: the cell's phi is not drawn so finely.
#define BEAM_NEAR_DEPTH 0.75
// And what is scattered nearer than the skin, at least this, a view ray meets only at the facet, where it starts or ends;
// what is deeper it meets in the cells, wherever it comes from (skin_depth). Nearer the cells would smear it over the
// surface; were it deeper, rays that pass below a lit surface would miss it. Chosen on balls
// (tests/physics/gather_skin.cpp).
#define BEAM_SKIN_DEPTH 0.2

// Where units went: counters [count][channel], low words, then high words.
#define BEAM_ENTERED 0
#define BEAM_NEAR 1      // scattered so near its facet that it drives the boundary condition
#define BEAM_IN_CELLS 2  // scattered deeper
#define BEAM_ABSORBED 3
#define BEAM_THROUGH 4  // left unscattered
#define BEAM_COUNTERS 5

// Where a beam lays down what it loses below the skin: layers of the deposits.
#define BEAM_DEEP 0     // source of the cells
#define BEAM_SHALLOW 1  // nearer than BEAM_NEAR_DEPTH: it drives the boundary condition, and the cells only show it
#define BEAM_LAYERS 2

// A place of the mesh in a facet.
struct BeamStart {
  vec3 position;  // h, from the grid's corner
  vec3 normal;    // unit, outward
  float area;     // h^2
  float slack;    // m, as a Receiver's
};

struct BeamPush {
  vec3 origin;  // of the grid, m
  ivec3 cells;
  int count;     // of cut cells, entry 0 included
  int channels;  // 1 or 3
  float eta, f_dt_outer, A, f_dt;
  float h;           // m
  float skin;        // h, at least
  vec3 kappa_scale;  // m
  vec3 unit;         // W; 0: no light in the channel
  SkyLinks sky;
  uint first, end;            // of the samples: a part of them at a time, the end is past the last
  uint group;                 // so many samples go as one beam
  uint round;                 // which start of each facet
  uint listed_first, listed;  // of the list of sides: those that have such a start
};

// `across`: the optical depth of a beam's way through one cell's depth, h sigma_t / mu. Light that falls off within a
// cell would be smeared over it and its neighbours, so from 1.5 on the facet keeps all of the near depth, up to 1 only
// `least`.
SHARED_FN real skin_depth(real across, real least) {
  real share = min(max(real(2) * across - real(2), real(0)), real(1));
  return least + share * max(real(BEAM_NEAR_DEPTH) - least, real(0));
}

// Mean of t over [0, 1] weighted with exp(-x t): where in a segment of optical depth x a beam is lost.
SHARED_FN real loss_place(real x) {
  if (x < real(0.02)) return real(0.5) - x / real(12);
  if (x > real(30)) return real(1) / x;
  return real(1) / x - real(1) / (exp(x) - real(1));
}

// Light scattered at depth z below the surface drives the fluence below it as a source on the boundary would, P1
// exactly: phi + 2 A kappa d_n phi = 4 f / F_dt with f = F_dt (2 A cosh(z / l) + l sinh(z / l) / kappa) / 4 of its
// flux, and the query then needs c = cosh(z / l) - f: cosh - 1 pays for what that fluence, carried on to the surface,
// absorbs too much.
SHARED_FN real buried_cosh(real z, real per_length) {
  real x = min(z * per_length, real(2));
  return real(0.5) * (exp(x) + exp(-x));
}
SHARED_FN real buried_boundary(real z, real per_length, real kappa, real A, real f_dt) {
  real x = min(z * per_length, real(2));
  real sinh_over_x = x < real(0.01) ? real(1) + x * x / real(6) : real(0.5) * (exp(x) - exp(-x)) / x;
  return real(0.25) * f_dt * (real(2) * A * buried_cosh(z, per_length) + z * sinh_over_x / kappa);
}

ALABASTER_END_SHARED

#endif
