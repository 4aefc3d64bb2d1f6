// Where a direction lies in a latitude-longitude picture of the environment. The top row is up (+y); the middle column
// looks along -z and columns go on towards +x, so that the picture is seen upright and unmirrored from inside. `turn` is
// what the picture is turned by about +y, counter-clockwise seen from above, in whole turns.
#ifndef ALABASTER_SHARED_ENVIRONMENT_H
#define ALABASTER_SHARED_ENVIRONMENT_H
#include "language.h"

#ifdef __cplusplus
#define ALABASTER_ARC_TANGENT std::atan2
#define ALABASTER_ARC_COSINE std::acos
#define ALABASTER_FLOOR std::floor
#else
#define ALABASTER_ARC_TANGENT atan
#define ALABASTER_ARC_COSINE acos
#define ALABASTER_FLOOR floor
#endif

ALABASTER_BEGIN_SHARED

// Of a unit direction (x, y, z): 0..1 from the left edge of the picture.
SHARED_FN real environment_column(real x, real z, real turn) {
  real u = ALABASTER_ARC_TANGENT(x, -z) * real(0.15915494309189535) + real(0.5) + turn;
  return u - ALABASTER_FLOOR(u);
}

// 0..1 from the top edge.
SHARED_FN real environment_row(real y) {
  return ALABASTER_ARC_COSINE(min(max(y, real(-1)), real(1))) * real(0.3183098861837907);
}

ALABASTER_END_SHARED

#endif
