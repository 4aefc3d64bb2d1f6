#include "scene/mesh_check.h"

#include <algorithm>
#include <array>
#include <map>
#include <sstream>

#include "scene/error.h"
#include "scene/inside.h"
#include "scene/mesh_edges.h"
#include "scene/mesh_holes.h"
#include "scene/mesh_weld.h"
#include "scene/shapes.h"

namespace alabaster {
namespace {

constexpr std::size_t largest_hole = 64;    // edges
constexpr double largest_patch = 0.02;      // of the object's area
constexpr float second_weld = 1e-6f;        // of the object's diagonal
constexpr double no_area = 1e-12;           // area / diagonal^2 of lines and points
constexpr double flat = 1e-9;               // volume / area^(3/2) below which a component encloses nothing
constexpr std::size_t nesting_samples = 8;  // points that must all lie inside for a component to count as nested
const unsigned nobody = ~0u;

std::string at(glm::vec3 p) {
  std::ostringstream text;
  text << "(" << p.x << ", " << p.y << ", " << p.z << ")";
  return text.str();
}

std::string count(std::size_t n, const std::string& what) {
  return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
}

class Check {
 public:
  Check(const Mesh& mesh, const std::string& name, const std::string& file, std::vector<std::string>& warnings)
      : mesh_(welded(mesh)), name_(name), file_(file), warnings_(warnings) {}

  Mesh run() {
    simplify();
    EdgeTable edges(mesh_);
    if (edges_with(edges, [](std::size_t n) { return n == 1; }) && weld_near()) edges = EdgeTable(mesh_);
    float size = mesh_.triangles.empty() ? 0 : glm::length(bounds_of(mesh_).size());
    if (area(mesh_) <= no_area * size * size) fail("has no area; give it a closed surface of some size");
    bool regular = edges_with(edges, [](std::size_t n) { return n != 2; }) == 0;
    orient(edges);
    if (!regular && close()) orient(EdgeTable(mesh_));  // a patch joins what it touches: the components change
    turn_outwards();
    if (!regular) check_balance();
    if (std::size_t gone = flip_needles(mesh_)) warn(count(gone, "triangle") + " without area replaced");
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw UserError(file_ + ": mesh '" + name_ + "' " + what); }
  void warn(const std::string& what) { warnings_.push_back("mesh '" + name_ + "': " + what); }

  void simplify() {
    std::size_t degenerate = drop_degenerate(mesh_), duplicate = drop_duplicates(mesh_);
    if (degenerate) warn(count(degenerate, "degenerate triangle") + " dropped");
    if (duplicate) warn(count(duplicate, "duplicate triangle") + " dropped");
  }

  /// Number of edges whose number of triangles passes `test`.
  template <typename Test>
  static std::size_t edges_with(const EdgeTable& edges, Test test) {
    std::size_t found = 0;
    edges.for_each([&](std::span<const HalfEdge> edge) { found += test(edge.size()); });
    return found;
  }

  /// Whether there was anything to weld.
  bool weld_near() {
    std::size_t before = mesh_.positions.size();
    Mesh nearer = welded(mesh_, second_weld * glm::length(bounds_of(mesh_).size()));
    if (nearer.positions.size() == before) return false;
    mesh_ = std::move(nearer);
    warn(count(before - mesh_.positions.size(), "vertex gap") + " closed by welding");
    simplify();
    return true;
  }

  /// Fills component_ and turns triangles until both sides of every two-sided edge run against each other.
  void orient(const EdgeTable& edges) {
    std::size_t n = mesh_.triangles.size();
    struct Neighbour {
      unsigned triangle = nobody;
      bool same_direction = false;  // as the mesh is given
    };
    std::vector<std::array<Neighbour, 3>> neighbours(n);
    edges.for_each([&](std::span<const HalfEdge> edge) {
      if (edge.size() == 2) {
        for (int i = 0; i < 2; ++i)
          neighbours[edge[i].triangle][edge[i].side] = {edge[1 - i].triangle, edge[0].up == edge[1].up};
      } else if (edge.size() % 2 == 1 && edge.size() > 1) {
        glm::uvec3 t = mesh_.triangles[edge[0].triangle];
        fail("is not manifold: " + std::to_string(edge.size()) + " triangles meet at the edge from " +
             at(mesh_.positions[t[edge[0].side]]) + "; remove inner faces so that every edge has two");
      }
    });
    component_.assign(n, nobody);
    components_ = 0;
    std::vector<bool> turned(n);
    std::size_t turned_total = 0;
    for (unsigned seed = 0; seed < n; ++seed) {
      if (component_[seed] != nobody) continue;
      std::vector<unsigned> members{seed};
      component_[seed] = components_;
      std::size_t turned_here = 0;
      for (std::size_t next = 0; next < members.size(); ++next) {
        unsigned t = members[next];
        for (Neighbour to : neighbours[t]) {
          if (to.triangle == nobody) continue;
          bool wanted = turned[t] != to.same_direction;
          if (component_[to.triangle] == nobody) {
            component_[to.triangle] = components_;
            turned[to.triangle] = wanted;
            turned_here += wanted;
            members.push_back(to.triangle);
          } else if (turned[to.triangle] != wanted) {
            fail("is one-sided near " + at(mesh_.positions[mesh_.triangles[t].x]) +
                 " (like a Moebius strip); rebuild it as a solid");
          }
        }
      }
      if (2 * turned_here > members.size()) {  // turn the few, not the many
        for (unsigned t : members) turned[t] = !turned[t];
        turned_here = members.size() - turned_here;
      }
      turned_total += turned_here;
      ++components_;
    }
    for (unsigned t = 0; t < n; ++t)
      if (turned[t]) std::swap(mesh_.triangles[t].y, mesh_.triangles[t].z);
    if (turned_total) warn(count(turned_total, "triangle") + " turned to agree with the others around");
  }

  /// Fills small holes; whether there were any.
  bool close() {
    std::vector<Hole> holes = find_holes(mesh_);
    if (holes.empty()) return false;
    double patches = 0;
    std::size_t most_edges = 0;
    for (const Hole& hole : holes) patches += hole.patch_area, most_edges = std::max(most_edges, hole.vertices.size());
    std::sort(holes.begin(), holes.end(), [](const Hole& a, const Hole& b) { return a.patch_area > b.patch_area; });
    std::string where;
    for (std::size_t i = 0; i < std::min<std::size_t>(3, holes.size()); ++i)
      where += (i ? "; " : "") + count(holes[i].vertices.size(), "edge") + " around " + at(holes[i].centre);
    if (holes.size() > 3) where += "; ...";
    if (most_edges > largest_hole || patches > largest_patch * area(mesh_))
      fail("is not closed: " + count(holes.size(), "hole") + " (" + where +
           "); fill them in the modelling program, or make the material opaque");
    for (const Hole& hole : holes) fill(mesh_, hole);
    warn(count(holes.size(), "hole") + " filled (" + where + ")");
    return true;
  }

  void turn_outwards() {
    struct Part {
      std::vector<unsigned> triangles;
      double six_volume = 0, area = 0;
    };
    std::vector<Part> parts(components_);
    for (unsigned t = 0; t < component_.size(); ++t) {
      Part& part = parts[component_[t]];
      part.triangles.push_back(t);
      glm::dvec3 origin = mesh_.positions[mesh_.triangles[part.triangles[0]].x];
      glm::dvec3 a = glm::dvec3(mesh_.positions[mesh_.triangles[t].x]) - origin;
      glm::dvec3 b = glm::dvec3(mesh_.positions[mesh_.triangles[t].y]) - origin;
      glm::dvec3 c = glm::dvec3(mesh_.positions[mesh_.triangles[t].z]) - origin;
      part.six_volume += glm::dot(a, glm::cross(b, c));
      part.area += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    std::vector<bool> drop(mesh_.triangles.size());
    std::size_t flat_parts = 0, turned = 0;
    std::vector<unsigned> depth = nesting_depths();
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (std::abs(parts[i].six_volume) / 6 <= flat * std::pow(parts[i].area, 1.5)) {
        for (unsigned t : parts[i].triangles) drop[t] = true;
        ++flat_parts;
      } else if ((parts[i].six_volume < 0) != (depth[i] % 2 == 1)) {
        for (unsigned t : parts[i].triangles) std::swap(mesh_.triangles[t].y, mesh_.triangles[t].z);
        ++turned;
      }
    }
    if (flat_parts == parts.size()) fail("encloses no volume; give it the shape of a solid");
    if (flat_parts) warn(count(flat_parts, "part") + " without volume dropped");
    if (turned) warn(count(turned, "part") + " inside out: turned");
    std::size_t index = 0;
    std::erase_if(mesh_.triangles, [&](glm::uvec3) { return drop[index++]; });
  }

  /// In how many other components each one lies as a whole.
  std::vector<unsigned> nesting_depths() const {
    std::vector<unsigned> depth(components_, 0);
    if (components_ == 1) return depth;
    std::vector<std::vector<unsigned>> triangles(components_);
    for (unsigned t = 0; t < component_.size(); ++t) triangles[component_[t]].push_back(t);
    MeshRays rays(mesh_);
    for (unsigned c = 0; c < components_; ++c) {
      std::map<unsigned, std::size_t> samples_inside;
      std::size_t samples = std::min(nesting_samples, triangles[c].size());
      for (std::size_t s = 0; s < samples; ++s) {
        glm::uvec3 t = mesh_.triangles[triangles[c][s * triangles[c].size() / samples]];
        glm::vec3 point = (mesh_.positions[t.x] + mesh_.positions[t.y] + mesh_.positions[t.z]) / 3.0f;
        for (unsigned around : components_around(rays, point, c)) ++samples_inside[around];
      }
      for (auto [around, hits] : samples_inside) depth[c] += hits == samples;
    }
    return depth;
  }

  /// The components other than `own` that most of three rays from `point` cross an odd number of times.
  std::vector<unsigned> components_around(const MeshRays& rays, glm::vec3 point, unsigned own) const {
    std::map<unsigned, int> votes;
    for (int i = 0; i < 3; ++i) {
      std::map<unsigned, bool> odd;
      for (Crossing crossing : rays.crossings(point, general_directions[i])) odd[component_[crossing.triangle]] ^= true;
      for (auto [component, is_odd] : odd) votes[component] += is_odd;
    }
    std::vector<unsigned> result;
    for (auto [component, n] : votes)
      if (component != own && n >= 2) result.push_back(component);
    return result;
  }

  /// Along an edge of four triangles and more as many must run up as down.
  void check_balance() const {
    EdgeTable(mesh_).for_each([&](std::span<const HalfEdge> edge) {
      auto up = std::count_if(edge.begin(), edge.end(), [](const HalfEdge& half) { return half.up; });
      if (2 * std::size_t(up) != edge.size())
        fail("is not manifold: " + std::to_string(edge.size()) + " triangles meet at the edge from " +
             at(mesh_.positions[mesh_.triangles[edge[0].triangle][edge[0].side]]) +
             " and do not bound a solid; separate the parts there");
    });
  }

  Mesh mesh_;
  const std::string &name_, &file_;
  std::vector<std::string>& warnings_;
  std::vector<unsigned> component_;  // of each triangle
  unsigned components_ = 0;
};

}  // namespace

Mesh checked_solid(const Mesh& mesh, const std::string& name, const std::string& file,
                   std::vector<std::string>& warnings) {
  return Check(mesh, name, file, warnings).run();
}

}  // namespace alabaster
