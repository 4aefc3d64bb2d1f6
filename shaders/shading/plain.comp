// Starts the picture: background, light sources, and opaque surfaces (Lambert, direct light and environment only), whose
// irradiance has been gathered at the places of plain_places.comp.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "lighting/environment.glsl"
#include "visible.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(push_constant, scalar) uniform Push { PlainPush push; };
layout(binding = 11, scalar) readonly buffer Objects { PlainObject objects[]; };
layout(binding = 12, scalar) readonly buffer TriangleObjects { int triangle_objects[]; };  // -1: not a plain one
layout(binding = 13, scalar) readonly buffer FirstPlaces { uint first_places[]; };         // of each pixel
layout(binding = 14, scalar) readonly buffer Irradiance { vec3 irradiance[]; };            // W/m^2
void main() {
  const CameraRays camera = push.camera;
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  if (any(greaterThanEqual(pixel, camera.size))) return;
  const uint samples = camera.edge * camera.edge;
  uint todo = 0;
  vec3 radiance = vec3(0), normal_sum = vec3(0);
  for (uint s = 0; s < samples; ++s) {
    const uint id = sample_id(camera, pixel, s);
    if (id == 0)
      radiance += environment_radiance(sample_ray(camera, pixel, s), push.environment_turn) / float(samples);
    else if (triangle_objects[id - 1] >= 0)
      todo |= 1u << s;
  }
  float distance_sum = 0, share = 0;
  uint place = first_places[pixel.y * camera.size.x + pixel.x];
  while (todo != 0) {
    const Hit hit = next_hit(camera, pixel, todo);
    const PlainObject object = objects[triangle_objects[hit.triangle]];
    const bool front = dot(hit.normal, hit.to_eye) > 0;
    const vec3 normal = front ? hit.normal : -hit.normal;
    if (object.emissive != 0) {
      if (front || object.two_sided != 0) radiance += hit.weight * object.colour;
    } else {
      radiance += hit.weight * object.colour * 0.318309886 * irradiance[place++];
    }
    normal_sum += hit.weight * normal;
    distance_sum += hit.weight * hit.distance;
    share += hit.weight;
  }
  imageStore(multiple, ivec2(pixel), vec4(0));
  imageStore(surface, ivec2(pixel), vec4(radiance, 0));
  imageStore(fluence, ivec2(pixel), vec4(0, 0, 0, distance_sum));
  imageStore(gamma_s, ivec2(pixel), vec4(0, 0, 0, share));
  imageStore(normals, ivec2(pixel), vec4(normal_sum, 0));
}
