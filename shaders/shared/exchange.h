// Light between surfaces: the links from facets to what they see, and what travels along them.
#ifndef ALABASTER_SHARED_EXCHANGE_H
#define ALABASTER_SHARED_EXCHANGE_H
#include "language.h"

ALABASTER_BEGIN_SHARED

// One side of a cut cell's surface that has area.
struct ExchangeSide {
  uint entry;  // 2 * cut cell + side
  float area;  // m^2
};

// What a side sees in one direction: an emitter (low 24 bits) and the reflectance there towards the side (high 8 bits,
// 255 is 1), or one of the two words below.
const uint link_open = 0xffffffffu;  // the environment
const uint link_dark = 0xfffffffeu;  // something that sends nothing (or is gathered otherwise: a light source)
const uint link_emitters = 0xfffffeu;

// Opaque places are lit by one in so many of the light samples at most, those in direction k of a facet by other ones than
// those in k + 1: all of a facet's places together have asked all.
const uint most_light_shares = 4;

const uint link_bins = 54;  // parts of the sphere that rays are put in order by

struct LinkPush {
  uint sides;       // ExchangeSide
  uint directions;
  uint first;       // link_facets: emitter of entry 0 of what is hit; link_opaque: of the first place
  uint object;      // link_facets, link_opaque: which object
  float eta;        // link_facets: index inside / outside of what is hit
  vec3 origin;      // link_facets: grid of what is hit, m
  float h;          // m
  vec3 albedo;      // link_opaque: of what is hit
  uint shares;      // links, link_opaque: of the light samples; direction k asks share k % shares
  uint share;       // link_opaque: which
};

struct ExchangePush {
  uint sides;
  uint directions;
  uint first;        // emitter of the receiving object's entry 0
  float eta;         // of the receiving object
  float f_dr_outer;  // mean reflectance of diffuse light from outside
  vec3 environment;  // W/m^2/sr, of open links
  uint lights;       // 0: without what the transport's own source brings in (lamps, environment, and what surfaces have
                     // sent so far)
};

// Direction k of n over a hemisphere about +z, evenly spread by the cosine (a sunflower's seeds on the unit disc);
// `turn` is in turns.
SHARED_FN real link_cosine(uint k, uint n) { return sqrt(real(1) - (real(k) + real(0.5)) / real(n)); }
SHARED_FN real link_angle(uint k, real turn) {
  return real(6.283185307179586) * (real(k) * real(0.6180339887498949) + turn);
}

ALABASTER_END_SHARED

#endif
