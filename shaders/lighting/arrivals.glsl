// The light of all samples at a receiver, one sample at a time: what gather() adds up, for those who ask where it comes from.
#include "lighting/gather.glsl"

struct Arrival {
  vec3 towards;  // the light, unit
  float cosine;  // with the receiver's normal; <= 0: nothing arrives
  vec3 flux;     // F_t L cos dw, W/m^2: what enters
};

uint arrivals() { return lighting.points + lighting.directions; }

vec3 environment_way(uint direction) {
  const mat4 m = views[lighting.first_view + direction].to_clip;
  return -normalize(vec3(m[0][2], m[1][2], m[2][2]));
}

// Flux of the environment that enters per weight cos F_t of its directions: so they add up to the closed form.
vec3 environment_share(Receiver r, float eta, float f_dt_outer) {
  float all = 0;
  for (uint i = 0; i < lighting.directions; ++i) {
    const float cosine = dot(r.normal, environment_way(i));
    if (cosine > 0) all += cosine * fresnel_transmittance(cosine, eta);
  }
  return all > 0 ? lighting.environment * (3.14159265358979 * f_dt_outer / all) : vec3(0);
}

Arrival point_arrival(LightPoint light, Receiver r, float eta) {
  float distance2;
  Arrival a = Arrival(way_to(light, r.position, distance2), 0, vec3(0));
  a.cosine = dot(r.normal, a.towards);
  const float sent = light_share(light.kind, -dot(light.normal, a.towards), light.cone.scale, light.cone.offset);
  if (a.cosine <= 0 || sent <= 0) return a;
  float lit = 1;
  for (uint v = 0; v < light.views; ++v) {
    bool inside;
    lit = look_up(light.first_view + v, r.position, r.normal, r.slack, inside);
    if (inside) break;
  }
  a.flux = light.intensity * (lit * point_transfer(a.cosine, sent, distance2, eta));
  return a;
}

Arrival arrival(uint i, Receiver r, float eta, vec3 environment) {
  if (i < lighting.points) return point_arrival(points[i], r, eta);
  Arrival a = Arrival(environment_way(i - lighting.points), 0, vec3(0));
  a.cosine = dot(r.normal, a.towards);
  if (a.cosine <= 0) return a;
  bool inside;
  const float lit = look_up(lighting.first_view + i - lighting.points, r.position, r.normal, r.slack, inside);
  a.flux = environment * (lit * a.cosine * fresnel_transmittance(a.cosine, eta));
  return a;
}
