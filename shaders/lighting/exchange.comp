// Light that enters each side of each cut cell: from the lamps (gathered before), along its links, and from the open
// environment (where push.lights is 0: only what surfaces send now over what they had sent before); and the radiance that it mirrors.
//   E_t = E_t,lamps + pi (1 - F_dr) sum_k F_t L_k / sum_k F_t      directions spread by the cosine
//   M = [R_lamps + pi F_dr sum_k F_r L_k / sum_k F_r] / (pi F_dr)  mirrored light leaves with F_r(cos) M in every direction:
// its flux is right, its directions are those of light from all around. In a furnace both are exact for any directions.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shared/exchange.h"
#include "shared/optics.h"
layout(local_size_x = 64) in;
layout(push_constant, scalar) uniform Push { ExchangePush push; };
layout(binding = 0, scalar) readonly buffer Sides { ExchangeSide sides[]; };
layout(binding = 1, scalar) readonly buffer Links { uint links[]; };                   // [direction][side]
layout(binding = 2, scalar) readonly buffer Transmitted { vec3 transmitted[]; };       // W/m^2/sr over F_t, of emitters
layout(binding = 3, scalar) readonly buffer Mirrored { vec3 mirrored[]; };             // W/m^2/sr over F_r, of emitters
layout(binding = 4, scalar) readonly buffer Direct { vec3 direct[]; };                 // W/m^2, F_t gathered
layout(binding = 5, scalar) readonly buffer Irradiance { vec3 irradiance[]; };         // W/m^2, gathered without F_t
layout(binding = 6, scalar) writeonly buffer Flux { vec3 flux[]; };                    // W/m^2, E_t or its part
layout(binding = 8, scalar) readonly buffer KnownTransmitted { vec3 known_transmitted[]; };  // as they were before
layout(binding = 9, scalar) readonly buffer KnownMirrored { vec3 known_mirrored[]; };
layout(binding = 7, scalar) writeonly buffer MirroredNext { vec3 mirrored_next[]; };

vec3 arriving(uint link) {
  if (link == link_open) return push.environment;
  if (link == link_dark) return vec3(0);
  const uint emitter = link & 0xffffffu;
  return mix(transmitted[emitter], mirrored[emitter], float(link >> 24) / 255.0);
}

// Of it what the transport's own source does not know of.
vec3 unknown(uint link, vec3 light) {
  if (push.lights != 0) return light;
  if (link == link_open || link == link_dark) return vec3(0);
  const uint emitter = link & 0xffffffu;
  return light - mix(known_transmitted[emitter], known_mirrored[emitter], float(link >> 24) / 255.0);
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= push.sides) return;
  vec3 through = vec3(0), back = vec3(0);
  float f_t = 0, f_r = 0;
  for (uint k = 0; k < push.directions; ++k) {
    const float reflectance = fresnel_reflectance(link_cosine(k, push.directions), push.eta);
    const uint link = links[k * push.sides + i];
    const vec3 light = arriving(link);
    through += (1 - reflectance) * unknown(link, light);
    back += reflectance * light;
    f_t += 1 - reflectance;
    f_r += reflectance;
  }
  const float pi = 3.14159265358979;
  const uint entry = sides[i].entry;
  flux[entry] = (push.lights != 0 ? direct[entry] : vec3(0)) + (pi * (1 - push.f_dr_outer) / f_t) * through;
  vec3 mirror = vec3(0);
  if (push.f_dr_outer > 0)
    mirror = (irradiance[entry] - direct[entry]) / (pi * push.f_dr_outer) + back / f_r;
  mirrored_next[push.first + entry] = max(mirror, vec3(0));
}
