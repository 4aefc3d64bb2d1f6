// Structs of the passes that mirror the scene in translucent objects.
#ifndef ALABASTER_SHARED_REFLECTION_H
#define ALABASTER_SHARED_REFLECTION_H
#include "shading.h"

ALABASTER_BEGIN_SHARED

const uint mirrored_opaque = 0, mirrored_emissive = 1, mirrored_translucent = 2;

// An object as a mirrored ray meets it.
struct MirroredObject {
  uint kind;            // mirrored_*
  vec3 colour;          // Lambert reflectance, or radiance in W/m^2/sr
  uint two_sided;       // emissive: shines from the back, too
  float light_density;  // emissive: probability per area that a light sample picks a point of it, 1/m^2
  float eta;            // translucent: index inside / index outside
  float alpha;          // translucent: roughness^2, 0 smooth
  float mean_deficit;   // of its rough lobe (shared/rough.h)
  vec3 grid_low;        // m; low corner of its glow
  float per_metre;      // texels
  vec3 grid_cells;      // texels
  vec2 glow_z;          // texels, where its two sides start in the glow image; negative: it is not solved and stays black
};

// A triangle of an area light.
struct Emitter {
  vec3 corner, edge1, edge2;  // m
  float below;                // share of the light samples that go to the triangles before it
  uint object;
};

struct GlowPush {
  ivec3 cells;
  int z;             // where the object's first side starts
  float A, f_dt;
  float exit_scale;  // 1 / eta^2, or 1 as printed
};

struct ReflectionPush {
  CameraRays camera;
  uvec2 corner;       // first pixel of the rectangle that holds the object
  uint first, count;  // the object's triangles
  uint object;        // in Scene::objects
  uint first_sample, end_sample;  // of each pixel; the end is past the last
  uint rays;          // a sample of the picture, where the surface is rough
  uint emitters;
  uint orders;        // mirrorings that are followed
  float environment_turn;  // shared/environment.h
};

ALABASTER_END_SHARED

#endif
