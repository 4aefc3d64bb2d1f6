#include "reference/world.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <stdexcept>

#include "scene/error.h"

namespace alabaster {
namespace {

constexpr float worth_guiding = 0.08f;  // chance of light below which a guide to it takes less time to equal error
constexpr float worth_depth = 10;       // mean free paths across below which distances are not worth their making

constexpr double even_sky = 0.5;    // evenness above which the environment's picture is left to chance
const glm::ivec2 sky_cells{16, 8};  // of the picture

float largest(glm::vec3 v) { return std::max({v.x, v.y, v.z}); }

/// Of the translucent objects, or of all where there is none.
Bounds what_matters(const Scene& scene) {
  Bounds bounds, all;
  for (const Object& object : scene.objects)
    for (const glm::vec3& p : object.mesh.positions) {
      all.add(p);
      if (object.role == Role::translucent) bounds.add(p);
    }
  return bounds.low.x <= bounds.high.x ? bounds : all;
}

}  // namespace

// What a ray query carries to the filter.
struct World::Query : RTCIntersectContext {
  const World* world;
  const Inside* inside;
  Leaving leaving;
};

void World::accept_or_reject(const RTCFilterFunctionNArguments* call) {
  const auto* query = static_cast<const Query*>(call->context);
  const auto* ray = reinterpret_cast<const RTCRay*>(call->ray);
  const auto* hit = reinterpret_cast<const RTCHit*>(call->hit);
  const Body& body = query->world->bodies_[hit->geomID];
  if (body.role != Role::translucent) {
    // Also what lies in the nudge before the start: the neighbour across an edge.
    const bool same_face = hit->primID == query->leaving.triangle || ray->tfar < 4 * query->world->nudge_;
    if (hit->geomID == query->leaving.object && same_face) call->valid[0] = 0;
    return;
  }
  const glm::vec3 n = query->world->shapes_[hit->geomID].normals[hit->primID];
  const bool entering = ray->dir_x * n.x + ray->dir_y * n.y + ray->dir_z * n.z < 0;
  if (entering == query->inside->holds(hit->geomID) || (entering && query->inside->full())) call->valid[0] = 0;
}

World::World(const Scene& scene, Guiding guiding) : device_(rtcNewDevice(nullptr)), environment_(scene.environment) {
  if (!device_) throw std::runtime_error("Embree: no device could be made");
  scene_.reset(rtcNewScene(device_.get()));
  rtcSetSceneFlags(scene_.get(),
                   static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  rtcSetSceneBuildQuality(scene_.get(), RTC_BUILD_QUALITY_HIGH);
  float reach = 0;
  for (const Object& object : scene.objects) {
    Body body;
    body.role = object.role;
    body.medium = FlatMedium(object.medium);
    body.eta = object.role == Role::translucent ? static_cast<float>(object.eta) : 1.0f;
    if (body.eta != 1 && object.roughness >= least_roughness) body.rough = make_rough_lobe(object.roughness, object.eta);
    body.albedo = object.albedo;
    body.radiance = object.radiance;
    body.two_sided = object.two_sided;
    bodies_.push_back(body);
    shapes_.push_back({object.mesh, {}, bounds_of(object.mesh)});
    add_geometry(static_cast<std::uint32_t>(bodies_.size() - 1));
    for (glm::vec3 p : object.mesh.positions) reach = std::max({reach, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  nudge_ = 1e-6f * reach;
  rtcCommitScene(scene_.get());
  for (std::uint32_t id = 0; id < bodies_.size(); ++id) add_lights(id);
  add_lamps(scene);
  share_out_lights(scene);
  for (std::uint32_t id = 0; id < bodies_.size(); ++id)
    bodies_[id].guided = guiding == Guiding::always || (guiding == Guiding::automatic &&
                                                        chance_of_light(shapes_[id].bounds.centre()) < worth_guiding);
  distances_.resize(bodies_.size());
  for (std::uint32_t id = 0; id < bodies_.size(); ++id)
    if (bodies_[id].role == Role::translucent) measure_distances(id);
}

void World::add_geometry(std::uint32_t id) {
  Shape& shape = shapes_[id];
  for (glm::uvec3 t : shape.mesh.triangles) {
    const glm::dvec3 a(shape.mesh.positions[t.x]), b(shape.mesh.positions[t.y]), c(shape.mesh.positions[t.z]);
    const glm::dvec3 n = glm::cross(b - a, c - a);
    const double length = glm::length(n);
    shape.normals.push_back(length > 0 ? glm::vec3(n / length) : glm::vec3(0, 0, 1));
  }
  RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  void* positions = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3),
                                            shape.mesh.positions.size());
  void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3),
                                            shape.mesh.triangles.size());
  std::copy(shape.mesh.positions.begin(), shape.mesh.positions.end(), static_cast<glm::vec3*>(positions));
  std::copy(shape.mesh.triangles.begin(), shape.mesh.triangles.end(), static_cast<glm::uvec3*>(triangles));
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene_.get(), geometry, id);
  rtcReleaseGeometry(geometry);
}

bool World::next_surface(glm::vec3 origin, glm::vec3 direction, float far, const Inside& inside, Leaving leaving,
                         Hit& hit) const {
  Query query;
  rtcInitIntersectContext(&query);
  query.filter = accept_or_reject;
  query.world = this;
  query.inside = &inside;
  query.leaving = leaving;
  RTCRayHit rh{};
  rh.ray.org_x = origin.x, rh.ray.org_y = origin.y, rh.ray.org_z = origin.z;
  rh.ray.dir_x = direction.x, rh.ray.dir_y = direction.y, rh.ray.dir_z = direction.z;
  rh.ray.tfar = far;
  rh.ray.mask = 0xffffffffu;
  rh.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene_.get(), &query, &rh);
  if (rh.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  hit.distance = rh.ray.tfar;
  hit.where = {rh.hit.geomID, rh.hit.primID};
  const Shape& shape = shapes_[rh.hit.geomID];
  hit.normal = shape.normals[rh.hit.primID];
  // Back onto the triangle's plane: the distance alone would leave the point off it by the rounding of a long ray.
  const glm::vec3 p = origin + rh.ray.tfar * direction;
  const glm::vec3 corner = shape.mesh.positions[shape.mesh.triangles[rh.hit.primID].x];
  hit.point = p - glm::dot(p - corner, hit.normal) * hit.normal;
  return true;
}

void World::add_lights(std::uint32_t id) {
  Body& body = bodies_[id];
  if (body.role != Role::emissive || largest(body.radiance) <= 0) return;
  const Shape& shape = shapes_[id];
  glm::dvec3 centroid(0);
  double total = 0;
  const double before = light_weights_.empty() ? 0.0 : light_weights_.back();
  for (std::uint32_t t = 0; t < shape.mesh.triangles.size(); ++t) {
    const glm::uvec3 v = shape.mesh.triangles[t];
    const glm::dvec3 a(shape.mesh.positions[v.x]), b(shape.mesh.positions[v.y]), c(shape.mesh.positions[v.z]);
    const double area = 0.5 * glm::length(glm::cross(b - a, c - a));
    total += area;
    centroid += area / 3 * (a + b + c);
    light_triangles_.push_back({id, t});
    light_weights_.push_back((light_weights_.empty() ? 0.0 : light_weights_.back()) +
                             area * static_cast<double>(largest(body.radiance)));
  }
  body.centre = glm::vec3(centroid / std::max(total, 1e-300));
  body.radius = static_cast<float>(std::sqrt(total / M_PI));
  body.light_share = static_cast<float>(light_weights_.back() - before);
}

// Weighted as light_triangles_ are, by intensity along the normal; a directional light as a point light that would give
// the same at twice the scene's size.
void World::add_lamps(const Scene& scene) {
  bool bends = false;
  for (const Object& object : scene.objects) bends = bends || (object.role == Role::translucent && object.eta != 1);
  const Bounds bounds = what_matters(scene);
  for (const PunctualLight& light : scene.lights) {
    if (light.intensity == glm::vec3(0)) continue;
    if (bends && light.radius <= 0)
      throw UserError(scene.path + ": light '" + light.name +
                      "' has no extent, and paths cannot find it behind a surface that bends light; give it " +
                      (light.kind == PunctualLight::Kind::directional ? "extras.angular_radius" : "extras.radius") +
                      " above 0, or the objects KHR_materials_ior 1");
    Lamp& lamp = lamps_.emplace_back(light, bounds);
    const float size = glm::length(bounds.size());
    lamp.share = largest(light.intensity) * (lamp.far() ? 4 * size * size : 1);
    light_weights_.push_back((light_weights_.empty() ? 0.0 : light_weights_.back()) + static_cast<double>(lamp.share));
  }
}

// The sky as a few dozen far lamps, for guides; the finer picture is drawn from where nothing bends the way.
void World::add_sky(const Bounds& bounds) {
  if (!environment_.picture || environment_.picture->evenness() > even_sky) return;
  const EnvironmentPicture& picture = *environment_.picture;
  struct Sum {
    glm::dvec3 towards{0};
    double light = 0;
  };
  std::vector<Sum> sums(static_cast<std::size_t>(sky_cells.x * sky_cells.y));
  const glm::ivec2 size = picture.size();
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      const glm::vec3 value = picture.texel({x, y});
      const double light = picture.solid_angle(y) * static_cast<double>(value.r + value.g + value.b) / 3;
      const glm::dvec3 towards = picture.direction((glm::dvec2(x, y) + 0.5) / glm::dvec2(size));
      Sum& sum = sums[sky_cell(glm::vec3(towards))];
      sum.towards += light * towards;
      sum.light += light;
    }
  const double far = 100 * static_cast<double>(glm::length(bounds.size()));
  for (const Sum& sum : sums) {
    LightDisc disc;
    const double length = glm::length(sum.towards);
    if (length > 0) {
      disc.centre = glm::vec3(glm::dvec3(bounds.centre()) + far / length * sum.towards);
      // A disc of angular radius r shortens the sum of its directions by r^2 / 4.
      disc.radius = static_cast<float>(far * 2 * std::sqrt(std::max(0.0, 1 - length / sum.light)));
      disc.share = static_cast<float>(sum.light / picture.total());
    }
    sky_.push_back(disc);
  }
}

std::uint32_t World::sky_cell(glm::vec3 direction) const {
  const EnvironmentPicture& picture = *environment_.picture;
  const glm::ivec2 cell = picture.texel_of(direction) * sky_cells / picture.size();
  return static_cast<std::uint32_t>(cell.y * sky_cells.x + cell.x);
}

glm::vec3 World::draw_sky(Random& random) const {
  const float row = random.uniform(), column = random.uniform(), u = random.uniform(), v = random.uniform();
  return environment_.picture->draw({row, column, u, v});
}

// Between lamps by intensity along the normal; between them and the sky by what each sends to the middle of the
// objects.
void World::share_out_lights(const Scene& scene) {
  const double power = light_weights_.empty() ? 1 : light_weights_.back();
  const Bounds bounds = what_matters(scene);
  add_sky(bounds);
  if (!sky_.empty()) {
    const float sky = static_cast<float>(environment_.picture->total()) / (4 * pi),
                lights = lights_seen_from(bounds.centre()).mean;
    sky_share_ = light_weights_.empty() ? 1 : std::clamp(sky / (sky + lights), 0.05f, 0.95f);
  }
  const float left = 1 - sky_share_;
  for (double& weight : light_weights_) weight *= static_cast<double>(left) / power;
  for (Body& body : bodies_) {
    body.light_density = left * static_cast<float>(static_cast<double>(largest(body.radiance)) / power);
    body.light_share *= left / static_cast<float>(power);
  }
  for (Lamp& lamp : lamps_) lamp.share *= left / static_cast<float>(power);
  double so_far = static_cast<double>(left);
  for (LightDisc& disc : sky_) {
    disc.share *= sky_share_;
    light_weights_.push_back(so_far += static_cast<double>(disc.share));
  }
}

// Without occlusion.
World::Shine World::lights_seen_from(glm::vec3 point) const {
  Shine shine;
  const auto add = [&](float share, glm::vec3 radiance) {
    shine.mean += share * largest(radiance);
    shine.square += share * largest(radiance) * largest(radiance);
  };
  for (Leaving at : light_triangles_) {
    const auto corners = this->corners(at);
    const glm::vec3 way = (corners[0] + corners[1] + corners[2]) / 3.0f - point;
    const float cosine = -glm::dot(way, normal(at)) / std::max(glm::length(way), 1e-20f);
    const float facing = bodies_[at.object].two_sided ? std::abs(cosine) : std::max(0.0f, cosine);
    const float area = 0.5f * glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
    add(std::min(0.5f, area * facing / std::max(glm::dot(way, way), 1e-20f) / (4 * pi)), bodies_[at.object].radiance);
  }
  for (const Lamp& lamp : lamps_) {
    const glm::vec3 way = lamp.centre - point;
    add(std::min(0.5f, lamp.radius * lamp.radius / std::max(glm::dot(way, way), 1e-20f) / 4), lamp.radiance);
  }
  return shine;
}

// (mean radiance)^2 / (mean squared radiance) over the sphere of directions: 1 in uniform light, the solid angle's
// share for one lamp. Its inverse is the variance of meeting light by chance.
float World::chance_of_light(glm::vec3 from) const {
  Shine shine = lights_seen_from(from);
  const EnvironmentPicture* picture = environment_.picture.get();
  const float sky = picture ? static_cast<float>(picture->total()) / (4 * pi) : largest(environment_.radiance);
  shine.mean += sky;
  shine.square += sky * sky / (picture ? static_cast<float>(picture->evenness()) : 1);
  return shine.square > 0 ? shine.mean * shine.mean / shine.square : 1;
}

LightPick World::sample_light(Random& random) const {
  const auto pick =
      std::upper_bound(light_weights_.begin(), light_weights_.end(), static_cast<double>(random.uniform()));
  const std::size_t picked =
      std::min(static_cast<std::size_t>(pick - light_weights_.begin()), light_weights_.size() - 1);
  LightPick light;
  const std::size_t before_sky = light_triangles_.size() + lamps_.size();
  if (picked >= before_sky) {
    light.sky = static_cast<std::uint32_t>(picked - before_sky);
    return light;
  }
  if (picked >= light_triangles_.size()) {
    light.lamp = static_cast<std::uint32_t>(picked - light_triangles_.size());
    return light;
  }
  const Leaving at = light_triangles_[picked];
  const Shape& shape = shapes_[at.object];
  const glm::uvec3 t = shape.mesh.triangles[at.triangle];
  const float root = std::sqrt(random.uniform()), v = random.uniform() * root;
  light.point =
      (1 - root) * shape.mesh.positions[t.x] + (root - v) * shape.mesh.positions[t.y] + v * shape.mesh.positions[t.z];
  light.normal = shape.normals[at.triangle];
  light.object = at.object;
  return light;
}

// Signed crossings along one ray: from inside an object it is left once more often than it is entered.
Inside World::inside_at(glm::vec3 point) const {
  const glm::dvec3 direction = glm::normalize(glm::dvec3(0.3717, 0.8291, 0.4173));
  Inside inside;
  for (std::uint32_t id = 0; id < bodies_.size(); ++id) {
    if (bodies_[id].role != Role::translucent || inside.full()) continue;
    const Shape& shape = shapes_[id];
    int leavings = 0;
    for (glm::uvec3 t : shape.mesh.triangles) {
      const glm::dvec3 a(shape.mesh.positions[t.x]), e(glm::dvec3(shape.mesh.positions[t.y]) - a),
          f(glm::dvec3(shape.mesh.positions[t.z]) - a);
      const glm::dvec3 n = glm::cross(e, f), s = glm::dvec3(point) - a;
      const double rate = glm::dot(direction, n);
      if (rate == 0) continue;
      const double along = -glm::dot(s, n) / rate;
      const glm::dvec3 p = s + along * direction;
      const double u = glm::dot(glm::cross(p, f), n), v = glm::dot(glm::cross(e, p), n), whole = glm::dot(n, n);
      if (along > 0 && u >= 0 && v >= 0 && u + v <= whole) leavings += rate > 0 ? 1 : -1;
    }
    if (leavings > 0) inside.push(id);
  }
  return inside;
}

void World::measure_distances(std::uint32_t id) {
  const Body& body = bodies_[id];
  const glm::vec3 size = shapes_[id].bounds.size();
  if (body.medium.empty() || body.medium.least_sigma_t() * std::min({size.x, size.y, size.z}) < worth_depth) return;
  std::vector<const Mesh*> surfaces;
  for (const Shape& shape : shapes_) surfaces.push_back(&shape.mesh);
  distances_[id] = DistanceGrid(shapes_[id].bounds, surfaces);
}

}  // namespace alabaster
