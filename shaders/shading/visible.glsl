// What a pixel sees, one surface at a time: samples of a pixel that see the same triangle are shaded once, at their mean
// place, with the triangle's own normal. Takes bindings 3 to 10.
#include "shared/shading.h"

layout(binding = 3) uniform usampler2D visible;  // triangle + 1 of each sample
layout(binding = 4, scalar) readonly buffer Positions { vec3 positions[]; };
layout(binding = 5, scalar) readonly buffer Triangles { uvec3 triangles[]; };
// Sums over the pixel's samples, each weighted by its share.
layout(binding = 6, rgba32f) uniform image2D multiple;  // rgb, share of translucent
layout(binding = 7, rgba32f) uniform image2D surface;   // rgb, share whose query bracket is negative
layout(binding = 8, rgba32f) uniform image2D fluence;   // rgb, distance
layout(binding = 9, rgba32f) uniform image2D gamma_s;   // rgb, share that sees anything
layout(binding = 10, rgba32f) uniform image2D normals;  // xyz

// Loops over what a pixel sees are written `do if (todo != 0) {..} while (todo != 0)`. Lavapipe runs a `while` once more than it
// turns; and what a turn computes it keeps for lanes that have ended only where it stands under an `if` of its own.
struct Hit {
  uint triangle;
  float weight;  // share of the pixel
  vec3 position;
  vec3 normal;  // of the face
  vec3 to_eye;  // unit
  float distance;
};

uint sample_id(CameraRays camera, uvec2 pixel, uint s) {
  return texelFetch(visible, ivec2(pixel * camera.edge + uvec2(s % camera.edge, s / camera.edge)), 0).x;
}

// Unit, from the eye through a sample.
vec3 sample_ray(CameraRays camera, uvec2 pixel, uint s) {
  const vec2 place = vec2(pixel) + (vec2(s % camera.edge, s / camera.edge) + 0.5) / float(camera.edge);
  const vec2 screen = 2 * place / vec2(camera.size) - 1;
  return normalize(camera.forward + screen.x * camera.right + screen.y * camera.down);
}

// What of a triangle is seen at a place of the picture, in pixels; weight 1.
Hit hit_at(CameraRays camera, uint triangle, vec2 place) {
  Hit hit;
  hit.triangle = triangle;
  hit.weight = 1;
  const vec2 screen = 2 * place / vec2(camera.size) - 1;
  const vec3 ray = camera.forward + screen.x * camera.right + screen.y * camera.down;

  // Moeller-Trumbore, held inside the triangle, which edge-on rays would leave by rounding.
  const uvec3 t = triangles[hit.triangle];
  const vec3 a = positions[t.x], ab = positions[t.y] - a, ac = positions[t.z] - a;
  const vec3 p = cross(ray, ac), from_a = camera.eye - a, q = cross(from_a, ab);
  const float det = dot(ab, p);
  const float inverse = abs(det) > 1e-35 ? 1 / det : 0;
  vec2 uv = clamp(vec2(dot(from_a, p), dot(ray, q)) * inverse, 0, 1);
  uv /= max(1, uv.x + uv.y);
  hit.position = a + uv.x * ab + uv.y * ac;
  hit.normal = normalize(cross(ab, ac));
  const vec3 to_eye = camera.eye - hit.position;
  hit.distance = length(to_eye);
  hit.to_eye = to_eye / hit.distance;
  return hit;
}

// The first sample of `todo` and all that see the same triangle; takes them off `todo`.
Hit next_hit(CameraRays camera, uvec2 pixel, inout uint todo) {
  const uint samples = camera.edge * camera.edge;
  const uint id = sample_id(camera, pixel, uint(findLSB(todo)));
  vec2 place = vec2(0);
  float number = 0;
  for (uint s = 0; s < samples; ++s) {
    if (sample_id(camera, pixel, s) != id) continue;
    todo &= ~(1u << s);
    place += vec2(s % camera.edge, s / camera.edge) + 0.5;
    number += 1;
  }
  Hit hit = hit_at(camera, id - 1, vec2(pixel) + place / (number * float(camera.edge)));
  hit.weight = number / float(samples);
  return hit;
}

// Sample `s` by itself.
Hit sample_hit(CameraRays camera, uvec2 pixel, uint s) {
  const vec2 place = (vec2(s % camera.edge, s / camera.edge) + 0.5) / float(camera.edge);
  return hit_at(camera, sample_id(camera, pixel, s) - 1, vec2(pixel) + place);
}

// The first sample of `todo` and all whose triangles face its way (to 15 degrees) and lie `near`, m, as one, with their mean normal;
// takes them off `todo`. For what changes smoothly with both.
Hit next_patch(CameraRays camera, uvec2 pixel, float near, inout uint todo) {
  Hit patch_ = sample_hit(camera, pixel, uint(findLSB(todo)));
  vec3 position = vec3(0), normal = vec3(0);
  float number = 0;
  for (uint left = todo; left != 0; left &= left - 1) {
    const uint s = uint(findLSB(left));
    const Hit hit = sample_hit(camera, pixel, s);
    if (dot(hit.normal, patch_.normal) < 0.985 || distance(hit.position, patch_.position) > near) continue;
    todo &= ~(1u << s);
    position += hit.position;
    normal += hit.normal;
    number += 1;
  }
  patch_.weight = number / float(camera.edge * camera.edge);
  patch_.position = position / number;
  patch_.normal = normalize(normal);
  const vec3 to_eye = camera.eye - patch_.position;
  patch_.distance = length(to_eye);
  patch_.to_eye = to_eye / patch_.distance;
  return patch_;
}
