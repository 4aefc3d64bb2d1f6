// Where the rays of links start and go.
#include "shared/exchange.h"
#include "shared/lighting.h"

// A turn of its own for each entry, so that the directions of neighbours fill each other's gaps.
float link_turn(uint entry) {
  uint x = entry * 0x9e3779b9u;
  x = (x ^ (x >> 16)) * 0x85ebca6bu;
  x = (x ^ (x >> 13)) * 0xc2b2ae35u;
  return float((x ^ (x >> 16)) >> 8) / 16777216.0;
}

// Duff et al. 2017, "Building an orthonormal basis, revisited".
vec3 link_direction(vec3 n, uint entry, uint k, uint directions) {
  const float sign_z = n.z >= 0 ? 1.0 : -1.0, a = -1 / (sign_z + n.z), b = n.x * n.y * a;
  const vec3 x = vec3(1 + sign_z * n.x * n.x * a, sign_z * b, -sign_z * n.x), y = vec3(b, sign_z + n.y * n.y * a, -n.y);
  const float c = link_cosine(k, directions), s = sqrt(1 - c * c), angle = link_angle(k, link_turn(entry));
  return normalize(s * cos(angle) * x + s * sin(angle) * y + c * n);
}

vec3 link_origin(Receiver r) { return r.position + r.slack * r.normal; }
