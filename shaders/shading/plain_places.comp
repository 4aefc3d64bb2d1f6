// Places on opaque surfaces whose irradiance the picture wants: first they are counted, and each pixel gets the number of its
// first; then they are written.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/lighting.h"
#include "visible.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const int writing = 0;
layout(push_constant, scalar) uniform Push { PlainPush push; };
layout(binding = 11, scalar) readonly buffer Objects { PlainObject objects[]; };
layout(binding = 12, scalar) readonly buffer TriangleObjects { int triangle_objects[]; };
layout(binding = 13, scalar) buffer FirstPlaces { uint first_places[]; };
layout(binding = 14, scalar) buffer Count { uint count; };
layout(binding = 15, scalar) writeonly buffer Places { Receiver places[]; };

void main() {
  const CameraRays camera = push.camera;
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(pixel, camera.size))) return;
  const uint at = pixel.y * camera.size.x + pixel.x;
  uint todo = 0, place = writing != 0 ? first_places[at] : 0;
  for (uint s = 0; s < camera.edge * camera.edge; ++s) {
    const uint id = sample_id(camera, pixel, s);
    if (id == 0) continue;
    const int object = triangle_objects[id - 1];
    if (object >= 0 && objects[object].emissive == 0) todo |= 1u << s;
  }
  while (todo != 0) {
    const Hit hit = next_hit(camera, pixel, todo);
    if (writing != 0)
      places[place] = Receiver(hit.position, dot(hit.normal, hit.to_eye) > 0 ? hit.normal : -hit.normal, 0);
    ++place;
  }
  if (writing == 0) first_places[at] = place > 0 ? atomicAdd(count, place) : 0;
}
