// The light of all samples at a receiver, one sample at a time: what gather.comp adds up, for those who ask where it comes from.
// Needs a push block with a SkyLinks; takes bindings 17, 18, 20 and 21.
#include "lighting/gather.glsl"
#include "lighting/link.glsl"

layout(binding = 17, scalar) readonly buffer Links { uint links[]; };        // [direction][side], with push.sky.sides
layout(binding = 18, scalar) readonly buffer SideOf { uint side_of[]; };     // of each entry: side or sky_no_side

struct Arrival {
  vec3 towards;  // the light, unit
  float cosine;  // with the receiver's normal; <= 0: nothing arrives
  vec3 flux;     // F_t L cos dw, W/m^2: what enters
};

layout(binding = 20, scalar) readonly buffer KnownTransmitted { vec3 known_transmitted[]; };  // of emitters (exchange.comp)
layout(binding = 21, scalar) readonly buffer KnownMirrored { vec3 known_mirrored[]; };

bool by_links() { return push.sky.sides > 0; }

uint arrivals() { return lighting.points + (by_links() ? push.sky.directions : lighting.directions); }

// All that is around one receiver.
struct Sky {
  uint entry, side;
  float share;  // of pi (1 - F_dr) L enters per weight of its directions: so they add up to the closed form
};

// Links are spread by the cosine: F_t is their weight. Of the lighting's directions it is cos F_t.
Sky sky_over(uint entry, Receiver r, float eta, float f_dt_outer) {
  Sky sky = Sky(entry, by_links() ? side_of[entry] : sky_no_side, 0);
  float all = 0;
  if (sky.side != sky_no_side)
    for (uint k = 0; k < push.sky.directions; ++k)
      all += fresnel_transmittance(link_cosine(k, push.sky.directions), eta);
  for (uint i = 0; i < (by_links() ? 0 : lighting.directions); ++i) {
    const float cosine = dot(r.normal, environment_way(i));
    if (cosine > 0) all += cosine * fresnel_transmittance(cosine, eta);
  }
  if (all > 0) sky.share = 3.14159265358979 * f_dt_outer / all;
  return sky;
}

Arrival point_arrival(LightPoint light, Receiver r, float eta) {
  float distance2;
  Arrival a = Arrival(way_to(light, r.position, distance2), 0, vec3(0));
  a.cosine = dot(r.normal, a.towards);
  const float sent = light_share(light.kind, -dot(light.normal, a.towards), light.cone.scale, light.cone.offset);
  if (a.cosine <= 0 || sent <= 0) return a;
  a.flux = light.intensity * (lit_share(light, r.position, r.normal, r.slack) * point_transfer(a.cosine, sent, distance2, eta));
  return a;
}

Arrival link_arrival(uint k, Receiver r, float eta, Sky sky) {
  Arrival a = Arrival(vec3(0), 0, vec3(0));
  const uint link = sky.side == sky_no_side ? link_dark : links[k * push.sky.sides + sky.side];
  if (link == link_dark || (link == link_open && push.sky.only_known != 0)) return a;
  vec3 light = lighting.environment;
  if (link != link_open) {
    const uint emitter = link & 0xffffffu;
    light = mix(known_transmitted[emitter], known_mirrored[emitter], float(link >> 24) / 255.0);
  }
  a.towards = link_direction(r.normal, sky.entry, k, push.sky.directions);
  a.cosine = link_cosine(k, push.sky.directions);
  a.flux = light * (sky.share * fresnel_transmittance(a.cosine, eta));
  return a;
}

Arrival arrival(uint i, Receiver r, float eta, Sky sky) {
  if (i < lighting.points) return point_arrival(points[i], r, eta);
  if (by_links()) return link_arrival(i - lighting.points, r, eta, sky);
  Arrival a = Arrival(environment_way(i - lighting.points), 0, vec3(0));
  a.cosine = dot(r.normal, a.towards);
  if (a.cosine <= 0) return a;
  bool inside;
  const float lit = look_up(lighting.first_view + i - lighting.points, r.position, r.normal, r.slack, inside);
  a.flux = lighting.environment * (sky.share * lit * a.cosine * fresnel_transmittance(a.cosine, eta));
  return a;
}
