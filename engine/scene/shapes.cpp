#include "scene/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <utility>

namespace alabaster {
namespace {

constexpr double two_pi = 6.283185307179586;

glm::dvec3 corner(const Mesh& mesh, glm::uvec3 triangle, int i) { return mesh.positions[triangle[i]]; }

glm::dvec3 twice_area(const Mesh& mesh, glm::uvec3 t) {
  glm::dvec3 a = corner(mesh, t, 0);
  return glm::cross(corner(mesh, t, 1) - a, corner(mesh, t, 2) - a);
}

/// Two triangles for the quadrilateral a b c d, counter-clockwise.
void add_quad(Mesh& mesh, unsigned a, unsigned b, unsigned c, unsigned d) {
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
}

/// Bands between circles of `segments` points that start at vertex `first`, each circle counter-clockwise seen from +y
/// (x to -z), from the bottom circle up.
void add_bands(Mesh& mesh, unsigned first, int circles, int segments) {
  for (int band = 0; band + 1 < circles; ++band)
    for (int s = 0; s < segments; ++s) {
      unsigned low = first + band * segments, next = (s + 1) % segments;
      add_quad(mesh, low + s, low + next, low + segments + next, low + segments + s);
    }
}

/// A point of the circle of `radius` at height y: x to -z with growing angle, counter-clockwise seen from above.
glm::vec3 on_circle(double radius, double y, double turn) {
  return glm::vec3(radius * std::cos(two_pi * turn), y, -radius * std::sin(two_pi * turn));
}

/// Fans that close a stack of circles to a point below and one above.
void add_caps(Mesh& mesh, unsigned first, int circles, int segments, float y) {
  unsigned bottom = unsigned(mesh.positions.size()), top = bottom + 1;
  mesh.positions.push_back({0, -y, 0});
  mesh.positions.push_back({0, y, 0});
  unsigned last = first + (circles - 1) * segments;
  for (int s = 0; s < segments; ++s) {
    unsigned next = (s + 1) % segments;
    mesh.triangles.push_back({bottom, first + next, first + s});
    mesh.triangles.push_back({top, last + s, last + next});
  }
}

}  // namespace

Mesh icosphere(int subdivisions, float radius) {
  const float p = 1.6180339887f;  // golden ratio
  Mesh mesh{{{-1, p, 0},
             {1, p, 0},
             {-1, -p, 0},
             {1, -p, 0},
             {0, -1, p},
             {0, 1, p},
             {0, -1, -p},
             {0, 1, -p},
             {p, 0, -1},
             {p, 0, 1},
             {-p, 0, -1},
             {-p, 0, 1}},
            {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
             {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
             {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
  for (int level = 0; level < subdivisions; ++level) {
    std::map<std::pair<unsigned, unsigned>, unsigned> middles;
    auto middle = [&](unsigned a, unsigned b) {
      auto [entry, fresh] =
          middles.try_emplace(std::pair(std::min(a, b), std::max(a, b)), unsigned(mesh.positions.size()));
      if (fresh) mesh.positions.push_back(0.5f * (mesh.positions[a] + mesh.positions[b]));
      return entry->second;
    };
    std::vector<glm::uvec3> finer;
    for (glm::uvec3 t : mesh.triangles) {
      unsigned ab = middle(t.x, t.y), bc = middle(t.y, t.z), ca = middle(t.z, t.x);
      for (glm::uvec3 child : {glm::uvec3(t.x, ab, ca), {ab, t.y, bc}, {ca, bc, t.z}, {ab, bc, ca}})
        finer.push_back(child);
    }
    mesh.triangles = std::move(finer);
    for (glm::vec3& v : mesh.positions) v = glm::normalize(v);
  }
  for (glm::vec3& v : mesh.positions) v = radius * glm::normalize(v);
  return mesh;
}

Mesh uv_sphere(int rings, int segments, float radius) {
  Mesh mesh;
  for (int ring = 1; ring < rings; ++ring) {
    double polar = 0.5 * two_pi * ring / rings;
    for (int s = 0; s < segments; ++s)
      mesh.positions.push_back(on_circle(radius * std::sin(polar), -radius * std::cos(polar), double(s) / segments));
  }
  add_bands(mesh, 0, rings - 1, segments);
  add_caps(mesh, 0, rings - 1, segments, radius);
  return mesh;
}

Mesh ellipsoid(int subdivisions, glm::vec3 radii) { return transformed(icosphere(subdivisions), scaling(radii)); }

Mesh box(glm::vec3 size, int divisions) {
  Mesh mesh;
  std::map<std::array<int, 3>, unsigned> vertices;  // by lattice position, so that faces share their edges
  auto vertex = [&](glm::ivec3 p) {
    auto [entry, fresh] = vertices.try_emplace({p.x, p.y, p.z}, unsigned(mesh.positions.size()));
    if (fresh) mesh.positions.push_back(size * (glm::vec3(p) / float(divisions) - 0.5f));
    return entry->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side)
      for (int i = 0; i < divisions; ++i)
        for (int j = 0; j < divisions; ++j) {
          auto at = [&](int u, int v) {
            glm::ivec3 p;
            p[axis] = side * divisions, p[(axis + 1) % 3] = i + u, p[(axis + 2) % 3] = j + v;
            return vertex(p);
          };
          unsigned a = at(0, 0), b = at(1, 0), c = at(1, 1), d = at(0, 1);
          if (side)
            add_quad(mesh, a, b, c, d);
          else
            add_quad(mesh, a, d, c, b);
        }
  return mesh;
}

Mesh torus(float major_radius, float minor_radius, int major_segments, int minor_segments) {
  Mesh mesh;
  for (int m = 0; m < minor_segments; ++m) {
    double angle = two_pi * m / minor_segments;
    for (int s = 0; s < major_segments; ++s)
      mesh.positions.push_back(on_circle(major_radius + minor_radius * std::cos(angle), minor_radius * std::sin(angle),
                                         double(s) / major_segments));
  }
  add_bands(mesh, 0, minor_segments, major_segments);
  unsigned last = (minor_segments - 1) * major_segments;
  for (int s = 0; s < major_segments; ++s) {
    unsigned next = (s + 1) % major_segments;
    add_quad(mesh, last + s, last + next, next, s);
  }
  return mesh;
}

Mesh cylinder(float radius, float height, int segments, int stacks) {
  Mesh mesh;
  for (int stack = 0; stack <= stacks; ++stack)
    for (int s = 0; s < segments; ++s)
      mesh.positions.push_back(on_circle(radius, height * (double(stack) / stacks - 0.5), double(s) / segments));
  add_bands(mesh, 0, stacks + 1, segments);
  add_caps(mesh, 0, stacks + 1, segments, 0.5f * height);
  return mesh;
}

Mesh quad(float size_x, float size_z) {
  float x = 0.5f * size_x, z = 0.5f * size_z;
  return {{{-x, 0, -z}, {-x, 0, z}, {x, 0, z}, {x, 0, -z}}, {{0, 1, 2}, {0, 2, 3}}};
}

Mesh transformed(Mesh mesh, const glm::dmat4& matrix) {
  for (glm::vec3& p : mesh.positions) p = glm::vec3(matrix * glm::dvec4(p, 1));
  return glm::determinant(glm::dmat3(matrix)) < 0 ? flipped(std::move(mesh)) : mesh;
}

Mesh flipped(Mesh mesh) {
  for (glm::uvec3& t : mesh.triangles) std::swap(t.y, t.z);
  return mesh;
}

Mesh joined(Mesh a, const Mesh& b) {
  unsigned offset = unsigned(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (glm::uvec3 t : b.triangles) a.triangles.push_back(t + offset);
  return a;
}

glm::dmat4 rotation(glm::dvec3 axis, double degrees) {
  return glm::rotate(glm::dmat4(1), degrees * two_pi / 360, glm::normalize(axis));
}
glm::dmat4 translation(glm::dvec3 offset) { return glm::translate(glm::dmat4(1), offset); }
glm::dmat4 scaling(glm::dvec3 factors) { return glm::scale(glm::dmat4(1), factors); }

glm::mat4 look_at(glm::dvec3 eye, glm::dvec3 target, glm::dvec3 up) {
  return glm::mat4(glm::inverse(glm::lookAt(eye, target, up)));
}

double signed_volume(const Mesh& mesh) {
  // About a vertex of the mesh and not the origin: far from the origin the sum would cancel away.
  if (mesh.triangles.empty()) return 0;
  glm::dvec3 origin = corner(mesh, mesh.triangles[0], 0);
  double six_volume = 0;
  for (glm::uvec3 t : mesh.triangles) six_volume += glm::dot(corner(mesh, t, 0) - origin, twice_area(mesh, t));
  return six_volume / 6;
}

double area(const Mesh& mesh) {
  double sum = 0;
  for (glm::uvec3 t : mesh.triangles) sum += 0.5 * glm::length(twice_area(mesh, t));
  return sum;
}

glm::dvec3 area_vector(const Mesh& mesh) {
  glm::dvec3 sum(0);
  for (glm::uvec3 t : mesh.triangles) sum += 0.5 * twice_area(mesh, t);
  return sum;
}

}  // namespace alabaster
