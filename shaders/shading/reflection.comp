// Adds what one translucent object mirrors in some of each pixel's samples: one ray a sample where the surface is smooth,
// and where it is rough `push.rays` mirrored ones and as many towards the lights, weighted by the balance heuristic
// (E. Veach, L. Guibas, "Optimally Combining Sampling Techniques for Monte Carlo Rendering", 1995). What goes into the
// object that a ray meets and comes out again belongs to `multiple`, all else to `surface`.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "lighting/gather.glsl"
#include "lighting/ray_tree.glsl"
#include "visible.glsl"
#include "shared/reflection.h"
layout(push_constant, scalar) uniform Push { ReflectionPush push; };
#include "reflection.glsl"
layout(local_size_x = 8, local_size_y = 8) in;

Mirrored mirrored(Hit hit, uint sample_, vec3 turn, LightShare lights) {
  const MirroredObject object = objects[push.object];
  const Frame frame = frame_of(hit.normal);
  const vec3 o = into(frame, hit.to_eye);
  // Edge-on, by the raster's rounding: it mirrors all, and nothing bends.
  if (o.z <= 0) return Mirrored(environment_radiance(-hit.to_eye, push.environment_turn), vec3(0));
  const float reflectance = fresnel_reflectance(o.z, object.eta);
  if (rough == 0 || object.alpha == 0) {
    const vec3 towards = -reflect(hit.to_eye, hit.normal);
    return follow(Leaving(hit.position, towards, reflectance, 0), lights, push.orders, turn);
  }
  // The environment's mean is mirrored in closed form; the rays bring what differs from it.
  Mirrored sum = Mirrored(vec3(0), vec3(0));
  const RoughView view = rough_view_of(push.object, o.z, object.eta);
  const float share = 1 / float(push.rays);
  float followed = 0;
  for (uint r = 0; r < push.rays; ++r) {
    const vec3 random = spread(turn, sample_ * push.rays + r);
    const vec3 i = rough_direction(o, object.alpha, view, random);
    if (i.z > 0) {
      const vec2 lobe = lobe_of(push.object, object, o, i, view);
      const Leaving leaving = Leaving(hit.position, out_of(frame, i), lobe.x / lobe.y, lobe.y);
      followed += share * leaving.throughput;
      sum = add(sum, follow(leaving, lights, push.orders, random.yzx), share);
    }
    if (push.emitters == 0) continue;
    const LightRay light = towards_light(hit.position, random.zxy, push.emitters);
    const vec3 to_light = into(frame, light.direction);
    if (light.density > 0 && to_light.z > 0 && reaches(hit.position, light)) {
      const vec2 lobe = lobe_of(push.object, object, o, to_light, view);
      sum.surface += share * lobe.x / (light.density + lobe.y) * light.radiance;
    }
  }
  sum.surface += (reflectance - followed) * lighting.environment;
  return sum;
}

void main() {
  // Neighbours in a vector of lanes lie in squares, not rows: their rays go alike ways.
  const uint lane = gl_LocalInvocationIndex;
  const uvec2 place = uvec2(bitfieldExtract(lane, 0, 1) | bitfieldExtract(lane, 2, 1) << 1 | bitfieldExtract(lane, 4, 1) << 2,
                            bitfieldExtract(lane, 1, 1) | bitfieldExtract(lane, 3, 1) << 1 | bitfieldExtract(lane, 5, 1) << 2);
  const uvec2 pixel = push.corner + 8 * gl_WorkGroupID.xy + place;
  if (any(greaterThanEqual(pixel, push.camera.size))) return;
  const uint samples = push.camera.edge * push.camera.edge;
  uint todo = 0;
  for (uint s = push.first_sample; s < push.end_sample; ++s)
    if (sample_id(push.camera, pixel, s) - 1 - push.first < push.count) todo |= 1u << s;
  if (todo == 0) return;

  Mirrored sum = Mirrored(vec3(0), vec3(0));
  do if (todo != 0) {
      const uint s = uint(findLSB(todo));
      sum = add(sum, mirrored(sample_hit(push.camera, pixel, s), s, turn_of(pixel), asked_of(s, samples)), 1);
      todo &= todo - 1;
    }
  while (todo != 0);
  const ivec2 at = ivec2(pixel);
  const float share = 1 / float(samples);
  imageStore(multiple, at, imageLoad(multiple, at) + vec4(share * sum.multiple, 0));
  imageStore(surface, at, imageLoad(surface, at) + vec4(share * sum.surface, 0));
}
