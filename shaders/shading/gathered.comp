// Adds what leaves one translucent object by the gather along each refracted view ray, times the level there. Lists the pixels
// where light goes through straight.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shading/gather_ray.glsl"
#include "visible.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant, scalar) uniform Push { TranslucentPush push; };
layout(binding = 13) uniform sampler3D levels;  // engine/shading/gather_levels.h
layout(binding = 14, scalar) buffer OpenPixels { uint open_groups[3], open_count, open_pixels[]; };
layout(binding = 15, rgba32f) uniform image2D single;
vec3 level_at(vec3 position, vec3 normal) {
  const vec3 size = vec3(textureSize(levels, 0)), nodes = vec3(size.xy, size.z / 6);
  const vec3 texel = clamp(position / grid.level_edge, vec3(0), nodes - 1) + 0.5;
  vec3 sum = vec3(0);
  for (int a = 0; a < 3; ++a) {
    const vec3 block = vec3(0, 0, nodes.z * float(2 * a + (normal[a] < 0 ? 1 : 0)));
    sum += normal[a] * normal[a] * textureLod(levels, (texel + block) / size, 0).rgb;
  }
  return sum;
}

void main() {
  const uvec2 pixel = push.corner + gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(pixel, push.camera.size))) return;
  const uint samples = push.camera.edge * push.camera.edge;
  uint todo = 0;
  for (uint s = 0; s < samples; ++s)
    if (sample_id(push.camera, pixel, s) - 1 - push.first < push.count) todo |= 1u << s;
  if (todo == 0) return;
  vec3 sum = vec3(0), once = vec3(0);
  bool open = false;
  do if (todo != 0) {
      const Hit hit = next_patch(push.camera, pixel, 0.3 * grid.h, todo);
      const vec3 at = (hit.position - grid.origin) / grid.h;
      const float cosine = clamp(dot(hit.normal, hit.to_eye), 0.001, 1);
      const vec3 inwards = refracted_inwards(hit.to_eye, hit.normal, cosine);
      const Gathered inside = gather_along(at, hit.normal, inwards, -log(STRAIGHT_LEAST_SHARE));
      const float scale = fresnel_transmittance(cosine, grid.eta) / (4 * 3.14159265358979 * grid.eta * grid.eta);
      once += hit.weight * scale * inside.single;
      sum += hit.weight * scale * (level_at(at, hit.normal) * exit_of(cosine) * inside.all - inside.single);
      open = open || inside.open;
    }
  while (todo != 0);
  const ivec2 at = ivec2(pixel);
  imageStore(multiple, at, imageLoad(multiple, at) + vec4(sum, 0));
  imageStore(single, at, imageLoad(single, at) + vec4(once, 0));
  if (!open) return;
  const uint slot = atomicAdd(open_count, 1);
  open_pixels[slot] = pixel.y * push.camera.size.x + pixel.x;
  atomicMax(open_groups[0], slot / OPEN_GROUP + 1);
  open_groups[1] = open_groups[2] = 1;
}
