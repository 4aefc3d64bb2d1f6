// Structs of the picture's passes, and the camera's rays.
#ifndef ALABASTER_SHARED_SHADING_H
#define ALABASTER_SHARED_SHADING_H
#include "language.h"

ALABASTER_BEGIN_SHARED

// A pinhole camera and its picture. Each pixel is seen through edge x edge regular samples.
struct CameraRays {
  vec3 eye;      // m, world
  vec3 right;    // from the picture's middle to its right edge, at distance 1
  vec3 down;     // to its lower edge
  vec3 forward;  // unit
  uvec2 size;    // pixels
  uint edge;     // samples along a pixel's edge
};

struct VisibilityPush {
  mat4 to_clip;
  uint first;  // triangle of the draw
};

// An opaque or emissive object.
struct PlainObject {
  vec3 colour;     // Lambert reflectance, or radiance in W/m^2/sr
  uint emissive;   // 1: colour is radiance
  uint two_sided;  // emissive: 1 shines from the back, too
};

struct PlainPush {
  CameraRays camera;
  float environment_turn;
};

struct TranslucentPush {
  CameraRays camera;
  uvec2 corner;       // first pixel of the rectangle that holds the object
  uint first, count;  // the object's triangles
  vec3 grid_low;      // m; the fluence image's low corner
  vec3 grid_inverse;  // 1/m; one over its edge lengths
  float eta, A, f_dt;
  float exit_scale;   // 1 / eta^2, or 1 as printed
};

// Single scattering of the lights from `first_light` to before `end_light`.
struct SinglePush {
  TranslucentPush picture;
  uint first_light, end_light;
};

ALABASTER_END_SHARED

#endif
