#include "reference/guide.h"

#include <algorithm>

#include "shared/optics.h"

namespace alabaster {
namespace {

constexpr int steps = 2;  // of Snell's law; the second knows the surface that the light really comes through
// Two Henyey-Greenstein lobes: one for the lamp's image, one for the images that other parts of the surface make.
constexpr float narrow_share = 0.75f, wide = 0.7f;
constexpr float of_radius = 0.4f;   // width of the narrow lobe, of the lamp's angular radius seen from outside
constexpr float roughness = 0.05f;  // radians more, for the triangles' unlike normals

// Turns `axis`, along which the surface at `hit` is seen from inside, to where light from `lamp` goes that comes in
// there; false, and nothing turned, where none does.
bool bend(const World& world, const Inside& inside, const Hit& hit, glm::vec3 lamp, glm::vec3& axis) {
  Inside beyond = inside;
  const bool leaving = glm::dot(axis, hit.normal) > 0;
  if (leaving)
    beyond.remove(hit.where.object);
  else
    beyond.push(hit.where.object);
  const float ratio = world.index_in(inside) / world.index_in(beyond);
  const glm::vec3 n = leaving ? hit.normal : -hit.normal, towards = glm::normalize(lamp - hit.point);
  const float cosine = glm::dot(towards, n);
  if (cosine <= 0 || 1 - cosine * cosine >= ratio * ratio) return false;
  axis = glm::normalize((towards - cosine * n) / ratio + refracted_cosine(cosine, ratio) * n);
  return true;
}

}  // namespace

LightGuide::LightGuide(const World& world, glm::vec3 point, const Inside& inside, std::uint32_t emitter) {
  const LightDisc disc = world.disc(emitter);
  const glm::vec3 way = disc.centre - point;
  const float distance = glm::length(way);
  useful_ = distance > disc.radius;
  if (!useful_) return;
  axis_ = way / distance;
  for (int step = 0; step < steps; ++step) {
    Hit hit;
    if (!world.next_surface(point, axis_, 2 * distance, inside, {}, hit)) break;
    if (world.body(hit.where.object).role != Role::translucent) break;
    if (!bend(world, inside, hit, disc.centre, axis_)) break;
  }
  picked_ = disc.share;
  narrow_ = 1 - std::min(1.0f, of_radius * disc.radius / distance + roughness);
}

float LightGuide::density(glm::vec3 direction) const {
  if (!useful_) return 0;
  const float cosine = glm::dot(axis_, direction);
  return picked_ * (narrow_share * phase_value(narrow_, cosine) + (1 - narrow_share) * phase_value(wide, cosine));
}

glm::vec3 LightGuide::sample(Random& random) const {
  const float g = random.uniform() < narrow_share ? narrow_ : wide;
  const float cosine = phase_cosine(g, random.uniform());
  return around(axis_, cosine, random.uniform());
}

}  // namespace alabaster
