// What is seen of the environment in a direction. Takes binding 15.
#include "shared/environment.h"

layout(binding = 15) uniform sampler2D environment_picture;  // W/m^2/sr; one texel where it is uniform

vec3 environment_radiance(vec3 direction, float turn) {
  return textureLod(environment_picture, vec2(environment_column(direction.x, direction.z, turn), environment_row(direction.y)), 0).rgb;
}
