#include "scene/inside.h"

#include <cstring>

namespace alabaster {
namespace {

RTCDevice device() {
  static RTCDevice shared = rtcNewDevice(nullptr);  // lives as long as the process
  return shared;
}

struct Query {
  RTCIntersectContext context;  // first: Embree hands back a pointer to it
  std::vector<Crossing>* found;
};

/// Notes the hit and rejects it, so that the ray goes on.
void collect(const RTCFilterFunctionNArguments* arguments) {
  auto* query = reinterpret_cast<Query*>(arguments->context);
  RTCRayN* ray = arguments->ray;
  RTCHitN* hit = arguments->hit;
  unsigned n = arguments->N;
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] != -1) continue;
    arguments->valid[i] = 0;
    float cosine = RTCRayN_dir_x(ray, n, i) * RTCHitN_Ng_x(hit, n, i) +
                   RTCRayN_dir_y(ray, n, i) * RTCHitN_Ng_y(hit, n, i) +
                   RTCRayN_dir_z(ray, n, i) * RTCHitN_Ng_z(hit, n, i);
    query->found->push_back({RTCHitN_primID(hit, n, i), cosine > 0});
  }
}

}  // namespace

const glm::vec3 general_directions[5] = {{0.617f, 0.331f, 0.714f},
                                         {-0.523f, 0.791f, 0.317f},
                                         {0.271f, -0.653f, 0.707f},
                                         {-0.739f, -0.417f, -0.529f},
                                         {0.459f, 0.577f, -0.676f}};

MeshRays::MeshRays(const Mesh& mesh) : scene_(rtcNewScene(device())) {
  RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3),
                                           mesh.positions.size());
  void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(glm::uvec3),
                                            mesh.triangles.size());
  std::memcpy(vertices, mesh.positions.data(), mesh.positions.size() * sizeof(glm::vec3));
  std::memcpy(triangles, mesh.triangles.data(), mesh.triangles.size() * sizeof(glm::uvec3));
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcSetSceneFlags(scene_.get(), RTCSceneFlags(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  rtcCommitScene(scene_.get());
}

std::vector<Crossing> MeshRays::crossings(glm::vec3 origin, glm::vec3 direction) const {
  std::vector<Crossing> found;
  Query query{{}, &found};
  rtcInitIntersectContext(&query.context);
  query.context.filter = collect;
  RTCRayHit ray{};
  ray.ray.org_x = origin.x, ray.ray.org_y = origin.y, ray.ray.org_z = origin.z;
  ray.ray.dir_x = direction.x, ray.ray.dir_y = direction.y, ray.ray.dir_z = direction.z;
  ray.ray.tfar = INFINITY;
  ray.ray.mask = ~0u;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene_.get(), &query.context, &ray);
  return found;
}

bool MeshRays::inside(glm::vec3 point) const {
  int votes = 0;
  for (glm::vec3 direction : general_directions) {
    int winding = 0;
    for (Crossing crossing : crossings(point, direction)) winding += crossing.outwards ? 1 : -1;
    votes += winding > 0;
  }
  return votes >= 3;
}

bool inside(const Mesh& mesh, glm::vec3 point) { return MeshRays(mesh).inside(point); }

}  // namespace alabaster
