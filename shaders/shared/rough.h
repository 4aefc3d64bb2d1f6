// A rough dielectric's mirrored light, one arithmetic for GLSL and C++: microfacets after Trowbridge and Reitz (GGX) with
// Smith's height-correlated shadowing, and what light reflected more than once between the facets adds, after C. Kulla,
// A. Conty, "Revisiting Physically Based Shading at Imageworks", 2017. Together they mirror exactly Fresnel's share of
// the smooth surface, F(o), in every direction o: what enters and what leaves is as with a smooth surface.
//   f(o, i) = s(o) F(h.o) D(h) G2(o, i) / (4 (n.o) (n.i)) + d(n.o) d(n.i) / (pi d_mean),   h = (o + i) / |o + i|
// E(o) = directional albedo of the first term without s; d = max(0, F - E); s = min(1, F / E), at least 0.94 for
// eta >= 1.1 and 1 nearly everywhere; d_mean = 2 integral_0^1 d(mu) mu dmu. alpha = roughness^2 (glTF).
#ifndef ALABASTER_SHARED_ROUGH_H
#define ALABASTER_SHARED_ROUGH_H
#include "optics.h"

ALABASTER_BEGIN_SHARED

// E at mu = (k / (rough_entries - 1))^2, linear between, for it is steep at grazing.
const int rough_entries = 64;

// Below this roughness a surface counts as smooth.
const float least_roughness = 0.03f;

// What a shader has to know of a rough surface at one direction o.
struct RoughView {
  float albedo;   // E(o)
  float deficit;  // d(o)
  float reflectance;  // F(o)
  float scale;    // s(o)
};

// D(h), 1/sr, of the cosine of h with the normal.
SHARED_FN real ggx_density(real cos_h, real alpha) {
  real c2 = cos_h * cos_h, a2 = alpha * alpha;
  real d = a2 * c2 + max(real(0), real(1) - c2);
  return a2 / (real(3.14159265358979) * d * d);
}

// Smith's Lambda of a direction; G1 = 1 / (1 + Lambda), G2 = 1 / (1 + Lambda(o) + Lambda(i)).
SHARED_FN real ggx_lambda(real cos_w, real alpha) {
  real c2 = max(cos_w * cos_w, real(1e-12));
  return real(0.5) * (sqrt(real(1) + alpha * alpha * (real(1) - c2) / c2) - real(1));
}

// First term of f times n.i, without s, 1/sr. `fresnel` = F(h.o).
SHARED_FN real ggx_value(real fresnel, real cos_o, real cos_i, real cos_h, real alpha) {
  real g2 = real(1) / (real(1) + ggx_lambda(cos_o, alpha) + ggx_lambda(cos_i, alpha));
  return fresnel * ggx_density(cos_h, alpha) * g2 / (real(4) * cos_o);
}

// Density, 1/sr, of directions i mirrored at normals that are seen from o.
SHARED_FN real ggx_mirrored_density(real cos_o, real cos_h, real alpha) {
  return ggx_density(cos_h, alpha) / ((real(1) + ggx_lambda(cos_o, alpha)) * real(4) * cos_o);
}

// A normal as seen from `o` (unit, z along the surface's normal, o.z >= 0), for u and v uniform in [0, 1): J. Dupuy,
// A. Benyoub, "Sampling Visible GGX Normals with Spherical Caps", 2023.
SHARED_INLINE vec3 visible_normal(vec3 o, float alpha, float u, float v) {
  vec3 stretched = normalize(vec3(alpha * o.x, alpha * o.y, o.z));
  float turn = 6.2831853f * u, z = (1.0f - v) * (1.0f + stretched.z) - stretched.z;
  float r = sqrt(max(0.0f, 1.0f - z * z));
  vec3 h = vec3(r * cos(turn), r * sin(turn), z) + stretched;
  return normalize(vec3(alpha * h.x, alpha * h.y, max(1e-7f, h.z)));
}

SHARED_INLINE RoughView rough_view(float albedo, float reflectance) {
  RoughView v;
  v.albedo = albedo;
  v.reflectance = reflectance;
  v.deficit = max(0.0f, reflectance - albedo);
  v.scale = albedo > reflectance ? reflectance / albedo : 1.0f;
  return v;
}

// Of the two ways to pick a direction the share that goes by visible normals; the rest goes by the cosine.
SHARED_INLINE float visible_share(RoughView o) {
  return o.reflectance > 0.0f ? 1.0f - o.deficit / o.reflectance : 1.0f;
}

// The direction i for three numbers uniform in [0, 1); below the surface (z <= 0) there is none.
SHARED_INLINE vec3 rough_direction(vec3 o, float alpha, RoughView at_o, vec3 uvw) {
  float share = visible_share(at_o);
  if (uvw.z < share) {
    vec3 h = visible_normal(o, alpha, uvw.x, uvw.y);
    return 2.0f * dot(o, h) * h - o;
  }
  float r = sqrt(uvw.x), turn = 6.2831853f * uvw.y;
  return vec3(r * cos(turn), r * sin(turn), sqrt(max(0.0f, 1.0f - uvw.x)));
}

// (f n.i, density with which rough_direction picks i), 1/sr. o and i above the surface, z along its normal.
SHARED_INLINE vec2 rough_value_and_density(vec3 o, vec3 i, float alpha, float eta, RoughView at_o, float deficit_i,
                                           float mean_deficit) {
  vec3 h = normalize(o + i);
  float cos_o = max(o.z, 1e-4f), share = visible_share(at_o);
  float fresnel = fresnel_reflectance(dot(o, h), eta);
  float value = at_o.scale * ggx_value(fresnel, cos_o, i.z, h.z, alpha) +
                at_o.deficit * deficit_i * i.z / (3.14159265f * mean_deficit);
  float density = share * ggx_mirrored_density(cos_o, h.z, alpha) + (1.0f - share) * i.z / 3.14159265f;
  return vec2(value, density);
}

ALABASTER_END_SHARED

#endif
