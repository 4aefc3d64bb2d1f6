#include "scene/punctual.h"

#include <algorithm>
#include <cmath>

#include "scene/closest.h"
#include "scene/error.h"
#include "scene/inside.h"

namespace alabaster {
namespace {

using Kind = PunctualLight::Kind;

constexpr double usual_extent = 0.02;  // radians, seen from the object
constexpr double right_angle = 1.5707963267948966;

void read_cone(const Fields& spot, PunctualLight& out) {
  out.inner_cone = spot.number_or("innerConeAngle", 0);
  out.outer_cone = spot.number_or("outerConeAngle", right_angle / 2);
  if (out.outer_cone <= 0 || out.outer_cone > right_angle + 1e-6)
    spot.fail("outerConeAngle", "must lie between 0 and pi/2 (radians)");
  if (out.inner_cone < 0 || out.inner_cone >= out.outer_cone)
    spot.fail("innerConeAngle", "must lie between 0 and outerConeAngle (radians)");
}

double read_radius(const Fields& light, Kind kind) {
  const char* key = kind == Kind::directional ? "angular_radius" : "radius";
  if (!light.is_object("extras") || !light.child("extras").has(key)) return -1;
  const Fields extras = light.child("extras");
  const double radius = extras.number(key);
  if (radius < 0) extras.fail(key, "must not be negative");
  if (kind == Kind::directional && radius > right_angle / 2) extras.fail(key, "must be at most pi/4 (radians)");
  return radius;
}

double nearest_surface(const Scene& scene, glm::dvec3 point, std::string& name) {
  double nearest = INFINITY;
  for (const Object& object : scene.objects)
    for (glm::uvec3 t : object.mesh.triangles) {
      const std::vector<glm::vec3>& p = object.mesh.positions;
      const double d = glm::distance(point, closest_on_triangle(point, p[t.x], p[t.y], p[t.z]).point);
      if (d < nearest) nearest = d, name = object.name;
    }
  return nearest;
}

glm::dvec3 middle_of_translucent(const Scene& scene) {
  Bounds bounds, all;
  for (const Object& object : scene.objects)
    for (const glm::vec3& p : object.mesh.positions) {
      all.add(p);
      if (object.role == Role::translucent) bounds.add(p);
    }
  return bounds.low.x <= bounds.high.x ? bounds.centre() : all.centre();
}

}  // namespace

PunctualLight read_punctual(const Fields& light, const glm::dmat4& to_world, std::vector<std::string>& warnings) {
  PunctualLight out;
  const std::string type = light.text("type");
  if (type != "point" && type != "spot" && type != "directional")
    light.fail("type", "must be \"point\", \"spot\" or \"directional\"");
  out.kind = type == "point" ? Kind::point : type == "spot" ? Kind::spot : Kind::directional;
  const glm::dvec3 colour = light.rgb_or("color", glm::dvec3(1));
  const double intensity = light.number_or("intensity", 1);
  if (glm::any(glm::lessThan(colour, glm::dvec3(0)))) light.fail("color", "must not be negative");
  if (intensity < 0) light.fail("intensity", "must not be negative");
  out.intensity = glm::vec3(intensity * colour);
  if (!std::isfinite(out.intensity.r + out.intensity.g + out.intensity.b)) light.fail("intensity", "is too large");
  if (out.kind == Kind::spot) read_cone(light.child("spot"), out);
  out.radius = read_radius(light, out.kind);
  out.position = glm::vec3(to_world[3]);
  const glm::dvec3 shines(to_world * glm::dvec4(0, 0, -1, 0));
  const double length = glm::length(shines);
  if (out.kind != Kind::point && !(length > 0))
    light.fail("", "shines nowhere: its node's scale is 0; give a scale without zeros");
  if (length > 0) out.direction = glm::vec3(shines / length);
  if (light.has("range"))
    warnings.push_back("KHR_lights_punctual: range is not used; light falls with the square of the distance");
  return out;
}

void give_extent(Scene& scene) {
  if (scene.lights.empty()) return;
  const glm::dvec3 middle = middle_of_translucent(scene);
  for (PunctualLight& light : scene.lights) {
    if (light.kind == Kind::directional) {
      if (light.radius < 0) light.radius = usual_extent;
      continue;
    }
    const std::string place = scene.path + ": light '" + light.name + "' ";
    for (const Object& object : scene.objects)
      if (object.role == Role::translucent && inside(object.mesh, light.position))
        throw UserError(place + "is inside the translucent object '" + object.name + "'; move it outside");
    std::string neighbour;
    const double nearest = nearest_surface(scene, light.position, neighbour);
    if (light.radius < 0)
      light.radius = std::min(usual_extent * glm::distance(middle, glm::dvec3(light.position)), 0.25 * nearest);
    if (light.radius > 0 && light.radius >= nearest)
      throw UserError(place + "reaches into '" + neighbour + "'; move it away, or give it a smaller extras.radius");
    if (nearest == 0) throw UserError(place + "lies on the surface of '" + neighbour + "'; move it away");
  }
}

}  // namespace alabaster
