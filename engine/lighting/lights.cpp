#include "lighting/lights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "lighting/shadow_views.h"
#include "lighting/sky_parts.h"
#include "scene/error.h"

namespace alabaster {
namespace {

constexpr int most_samples = most_light_points;
constexpr int most_of_punctual = 8;

struct Light {
  int object = -1;  // or
  const PunctualLight* punctual = nullptr;
  std::vector<double> area_below;  // m^2; running sum over an object's triangles
  double area() const { return area_below.back(); }
  double power = 0;  // W up to a common factor
  int samples = 1;
  int most = most_samples;
};

Light make_light(const Scene& scene, int index) {
  const Object& object = scene.objects[index];
  Light light;
  light.object = index;
  double sum = 0;
  for (const glm::uvec3& t : object.mesh.triangles) {
    const glm::dvec3 a = object.mesh.positions[t.x], b = object.mesh.positions[t.y], c = object.mesh.positions[t.z];
    light.area_below.push_back(sum += 0.5 * glm::length(glm::cross(b - a, c - a)));
  }
  const glm::dvec3 radiance = object.radiance;
  if (sum > 0) light.power = sum * (radiance.r + radiance.g + radiance.b) * (object.two_sided ? 2 : 1);
  return light;
}

/// `power` in the unit of make_light(): a patch of radiance L and area S has L S, so an intensity I into a solid angle
/// W counts I W / pi. Of a directional light counts what falls on the disc that `focus` shows it.
Light make_punctual(const PunctualLight& punctual, const Focus& focus) {
  Light light;
  light.punctual = &punctual;
  const double sum = double(punctual.intensity.r) + double(punctual.intensity.g) + double(punctual.intensity.b);
  const double half = 0.5 * (punctual.inner_cone + punctual.outer_cone);
  light.power = sum * (punctual.kind == PunctualLight::Kind::point  ? 4
                       : punctual.kind == PunctualLight::Kind::spot ? 2 * (1 - std::cos(half))
                                                                    : focus.radius * focus.radius);
  light.most = punctual.radius > 0 ? most_of_punctual : 1;
  return light;
}

/// Shares `samples` out by power, at least one each, largest remainders first.
void share_out(std::vector<Light>& lights, int samples) {
  const int spare = std::max(0, samples - static_cast<int>(lights.size()));
  double power = 0;
  for (const Light& light : lights) power += light.power;
  std::vector<std::pair<double, std::size_t>> remainders;
  int given = 0;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const double share = spare * lights[i].power / std::max(power, 1e-300);
    lights[i].samples = 1 + static_cast<int>(share);
    given += static_cast<int>(share);
    remainders.push_back({std::floor(share) - share, i});
  }
  std::sort(remainders.begin(), remainders.end());
  for (int i = 0; i < spare - given; ++i) ++lights[remainders[i % remainders.size()].second].samples;
  for (Light& light : lights) light.samples = std::min(light.samples, light.most);
}

/// Golden-ratio sequence: with i / n it makes a Fibonacci lattice, the evenest there is in two dimensions.
double golden(int i) {
  const double x = 0.5 + 0.6180339887498949 * i;
  return x - std::floor(x);
}

using Triangle = std::array<glm::dvec3, 3>;

/// n points of a triangle, a Fibonacci lattice, moved so that their mean is the triangle's, and stretched about it so
/// that their mean square distance from it is, as far as none leaves the triangle: what falls on a receiver in the open
/// is right to second order in the triangle's size.
std::vector<glm::dvec3> spread_points(const Triangle& t, int n) {
  std::vector<glm::dvec2> points;  // shares of the second and the third corner
  glm::dvec2 mean(0);
  for (int i = 0; i < n; ++i) {
    const double root = std::sqrt((i + 0.5) / n), turn = golden(i);
    points.emplace_back(root * (1 - turn), root * turn);
    mean += points.back() / double(n);
  }
  const glm::dvec3 second = t[1] - t[0], third = t[2] - t[0], middle = (t[0] + t[1] + t[2]) / 3.0;
  double wanted = 0, found = 0, room = INFINITY;
  for (const glm::dvec3& corner : t) wanted += glm::dot(corner - middle, corner - middle) / 12;
  for (glm::dvec2& p : points) {
    p -= mean;
    const glm::dvec3 off = p.x * second + p.y * third;
    found += glm::dot(off, off) / n;
    for (const double inwards : {p.x, p.y, -p.x - p.y})  // of the three corners' shares, each 1/3 in the middle
      if (inwards < 0) room = std::min(room, 0.9999 / (-3 * inwards));
  }
  const double stretch = n > 1 ? std::min(std::sqrt(wanted / found), room) : 0;
  std::vector<glm::dvec3> result;
  for (const glm::dvec2& p : points) result.push_back(middle + stretch * (p.x * second + p.y * third));
  return result;
}

/// n points, shared out to the triangles by area. Where each has one, those of a triangle stand for its area; where
/// there are fewer points than that, each stands for as much as any other.
std::vector<LightSample> sample_mesh(const Light& light, const Object& object, int n) {
  const std::size_t triangles = object.mesh.triangles.size();
  const auto points_below = [&](std::size_t k) {
    return k ? static_cast<int>(std::floor(light.area_below[k - 1] / light.area() * n + 0.5)) : 0;
  };
  bool each = true;
  for (std::size_t k = 0; k < triangles; ++k) each = each && points_below(k + 1) > points_below(k);
  std::vector<LightSample> samples;
  for (std::size_t k = 0; k < triangles; ++k) {
    const int count = points_below(k + 1) - points_below(k);
    if (count == 0) continue;
    Triangle corners;
    for (int c = 0; c < 3; ++c) corners[c] = object.mesh.positions[object.mesh.triangles[k][c]];
    const double area = light.area_below[k] - (k ? light.area_below[k - 1] : 0);
    LightSample sample;
    sample.normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
    sample.intensity = object.radiance * static_cast<float>(each ? area / count : light.area() / n);
    sample.kind = object.two_sided ? light_two_sided : light_one_sided;
    sample.object = light.object;
    for (const glm::dvec3& point : spread_points(corners, count)) {
      sample.position = point;
      samples.push_back(sample);
    }
  }
  return samples;
}

/// Point i of n on the disc that a punctual light shows to `target`, evenly spread and of equal weight.
LightSample sample_point(const PunctualLight& light, glm::dvec3 target, int i, int n) {
  using Kind = PunctualLight::Kind;
  LightSample sample;
  sample.kind = light.kind == Kind::point ? light_point : light.kind == Kind::spot ? light_spot : light_directional;
  sample.position = light.position;
  sample.normal = light.direction;
  sample.intensity = light.intensity / static_cast<float>(n);
  if (light.kind == Kind::spot) sample.cone = spot_cone(light);
  if (n == 1) return sample;

  const bool far = light.kind == Kind::directional;
  const glm::dvec3 way = far ? glm::dvec3(light.direction) : target - glm::dvec3(light.position);
  const glm::dvec3 forward = glm::length(way) > 0 ? glm::normalize(way) : glm::dvec3(0, 0, 1);
  const glm::dvec3 aside = std::abs(forward.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(aside, forward)), v = glm::cross(forward, u);
  const double share = (i + 0.5) / n, turn = 2.399963229728653 * i;  // golden angle
  const glm::dvec3 rim = std::cos(turn) * u + std::sin(turn) * v;
  if (!far) {
    sample.position += glm::vec3(light.radius * std::sqrt(share) * rim);
    return sample;
  }
  // Even in solid angle; the mean cosine of the disc, (1 + cos radius) / 2, is made up for.
  const double cosine = 1 - share * (1 - std::cos(light.radius));
  sample.normal = glm::normalize(cosine * forward + std::sqrt(1 - cosine * cosine) * rim);
  sample.intensity *= static_cast<float>(2 / (1 + std::cos(light.radius)));
  return sample;
}

/// Orders samples of one light so that each half, quarter and so on of them lies together.
void put_together(std::vector<LightSample>::iterator first, std::vector<LightSample>::iterator end) {
  if (end - first < 3) return;
  const auto place = [](const LightSample& s) { return s.kind == light_directional ? s.normal : s.position; };
  Bounds box;
  for (auto s = first; s != end; ++s) box.add(place(*s));
  const glm::vec3 size = box.size();
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::stable_sort(first, end,
                   [&](const LightSample& a, const LightSample& b) { return place(a)[axis] < place(b)[axis]; });
  const auto middle = first + (end - first) / 2;
  put_together(first, middle);
  put_together(middle, end);
}

LightSample sample_of(const SkyPart& part) {
  LightSample sample;
  sample.kind = light_directional;
  sample.normal = -part.direction;
  sample.intensity = part.flux;
  sample.cone.scale = part.spread;
  return sample;
}

}  // namespace

SpotCone spot_cone(const PunctualLight& light) {
  const double inner = std::cos(light.inner_cone), outer = std::cos(light.outer_cone);
  const double scale = 1 / std::max(1e-3, inner - outer);
  return {static_cast<float>(scale), static_cast<float>(-outer * scale)};
}

LightSamples sample_lights(const Scene& scene, int samples, int directions) {
  if (samples < 1 || samples > most_samples || directions < 0 || directions > most_samples)
    throw UserError("light samples: " + std::to_string(samples) + " points and " + std::to_string(directions) +
                    " directions; choose 1 to " + std::to_string(most_samples) +
                    " points and at most as many directions");
  std::vector<Light> lights;
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    if (scene.objects[i].role == Role::emissive && !scene.objects[i].mesh.triangles.empty()) {
      Light light = make_light(scene, static_cast<int>(i));
      if (light.power > 0) lights.push_back(std::move(light));
    }
  const Focus focus = scene.lights.empty() ? Focus{} : shadow_focus(scene);
  for (const PunctualLight& punctual : scene.lights)
    if (punctual.intensity != glm::vec3(0)) lights.push_back(make_punctual(punctual, focus));

  LightSamples result;
  result.environment = scene.environment.radiance;
  if (!lights.empty()) share_out(lights, samples);
  const auto first_of_next = [&] { return static_cast<std::ptrdiff_t>(result.area.size()); };
  for (const Light& light : lights) {
    const std::ptrdiff_t first = first_of_next();
    if (light.punctual)
      for (int i = 0; i < light.samples; ++i)
        result.area.push_back(sample_point(*light.punctual, focus.centre, i, light.samples));
    else
      for (const LightSample& sample : sample_mesh(light, scene.objects[light.object], light.samples))
        result.area.push_back(sample);
    put_together(result.area.begin() + first, result.area.end());
  }
  if (scene.environment.picture && directions > 0) {
    const std::ptrdiff_t first = first_of_next();
    for (const SkyPart& part : cut_sky(*scene.environment.picture, directions)) result.area.push_back(sample_of(part));
    put_together(result.area.begin() + first, result.area.end());
  }
  if (result.area.size() > most_samples)
    throw UserError(scene.path + ": " + std::to_string(lights.size()) +
                    " emissive meshes and lights, and the environment's parts, where " + std::to_string(most_samples) +
                    " are the most; join some of them");

  if (result.environment == glm::vec3(0)) return result;
  for (int i = 0; i < directions; ++i) {
    const double z = 1 - (2 * i + 1.0) / directions, turn = 2.399963229728653 * i;  // golden angle
    const double r = std::sqrt(1 - z * z);
    result.directions.push_back({r * std::cos(turn), r * std::sin(turn), z});
  }
  return result;
}

}  // namespace alabaster
