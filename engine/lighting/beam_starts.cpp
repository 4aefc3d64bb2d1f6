#include "lighting/beam_starts.h"

#include <algorithm>
#include <cmath>

#include "domain/cut_cells.h"

namespace alabaster {

static_assert(sizeof(BeamStart) == 32);

namespace {

// A group of pieces is parted while its area vector is that much shorter than its area: normals some 14 degrees off
// their mean.
constexpr double straight_enough = 0.97;

/// Pieces of surface that one beam stands for.
struct Group {
  std::vector<const SurfacePiece*> pieces;
  double area = 0;                       // h^2
  glm::dvec3 area_vector{0}, moment{0};  // h^2, h^3

  void add(const SurfacePiece& piece) {
    pieces.push_back(&piece);
    area += piece.area;
    area_vector += piece.area * piece.normal;
    moment += piece.area * piece.centroid;
  }
  double straight() const { return glm::length(area_vector) / area; }
  double bent() const { return area - glm::length(area_vector); }
};

BeamStart start_of(glm::dvec3 place, glm::dvec3 area_vector, double area, double scale, float h) {
  const double size = glm::length(area_vector), straight = std::min(size / area, 1.0);
  return {glm::vec3(place), glm::vec3(area_vector / size), static_cast<float>(scale * area),
          static_cast<float>(h * (0.02 + 0.5 * std::sqrt(1 - straight * straight)))};
}

/// In two, by the pieces whose normals are farthest from the mean and from that one.
std::array<Group, 2> part(const Group& group) {
  const auto farthest = [&](glm::dvec3 from) {
    return *std::max_element(
        group.pieces.begin(), group.pieces.end(), [&](const SurfacePiece* a, const SurfacePiece* b) {
          return a->area * (1 - glm::dot(a->normal, from)) < b->area * (1 - glm::dot(b->normal, from));
        });
  };
  const glm::dvec3 first = farthest(glm::normalize(group.area_vector + glm::dvec3(1e-30)))->normal,
                   second = farthest(first)->normal;
  std::array<Group, 2> parts;
  for (const SurfacePiece* piece : group.pieces)
    parts[glm::dot(piece->normal, first) < glm::dot(piece->normal, second)].add(*piece);
  return parts;
}

/// The facet's groups: the most bent one is parted first.
std::vector<Group> groups_of(Group all) {
  std::vector<Group> groups{std::move(all)};
  while (groups.size() < BEAM_MOST_STARTS) {
    const auto worst = std::max_element(groups.begin(), groups.end(),
                                        [](const Group& a, const Group& b) { return a.bent() < b.bent(); });
    if (worst->straight() > straight_enough) break;
    std::array<Group, 2> parts = part(*worst);
    if (parts[0].pieces.empty() || parts[1].pieces.empty()) break;
    *worst = std::move(parts[0]);
    groups.push_back(std::move(parts[1]));
  }
  return groups;
}

/// Which facets pieces belong to.
class Owners {
 public:
  Owners(const GridFrame& frame, const std::vector<GpuCutCell>& cut_cells) : n_(frame.cells), cut_cells_(cut_cells) {
    index_.assign(std::size_t(n_.x) * n_.y * n_.z, 0);
    for (std::uint32_t i = 1; i < cut_cells.size(); ++i) index_[at(cut_cells[i].cell)] = i;
  }

  /// 0: none, its facet was too small. A neighbour's where a slit's sheet was given to it (cut_cells.h).
  std::uint32_t entry(const SurfacePiece& piece) const {
    const int side = facet_class(piece.normal) & 1;
    const std::uint32_t own = index_[at(piece.cell)];
    if (own != 0 && cut_cells_[own].side[side].area > 0) return 2 * own + side;
    std::uint32_t nearest = 0;
    double least = 1;  // h
    for (int k = 0; k < 6; ++k) {
      glm::ivec3 cell = piece.cell;
      cell[k / 2] += k % 2 == 0 ? -1 : 1;
      if (glm::any(glm::greaterThanEqual(glm::uvec3(cell), glm::uvec3(n_)))) continue;
      const std::uint32_t index = index_[at(cell)];
      if (index == 0 || cut_cells_[index].side[side].area <= 0) continue;
      const double away =
          glm::distance(piece.centroid, glm::dvec3(cell) + glm::dvec3(cut_cells_[index].side[side].centre));
      if (away < least) least = away, nearest = 2 * index + side;
    }
    return nearest;
  }

 private:
  std::size_t at(glm::ivec3 c) const { return c.x + std::size_t(n_.x) * (c.y + std::size_t(n_.y) * c.z); }

  const glm::ivec3 n_;
  const std::vector<GpuCutCell>& cut_cells_;
  std::vector<std::uint32_t> index_;  // into cut_cells, of every cell
};

/// Adds a facet's groups, or the facet itself where there are none.
void add_starts(const std::vector<Group>& groups, const GpuCutCell& cut, const GpuFacet& side, float h,
                BeamStarts& out) {
  double area = 0;
  for (const Group& group : groups) area += group.straight() > 0 ? group.area : 0;
  out.of.emplace_back(out.starts.size(), 0);
  for (const Group& group : groups)
    if (group.straight() > 0)
      out.starts.push_back(start_of(group.moment / group.area, group.area_vector, group.area, side.area / area, h));
  if (area <= 0 && side.area > 0 && glm::length(side.area_vector) > 0)
    out.starts.push_back(start_of(glm::dvec3(cut.cell) + glm::dvec3(side.centre), side.area_vector, side.area, 1, h));
  out.of.back().y = static_cast<std::uint32_t>(out.starts.size()) - out.of.back().x;
  out.most = std::max(out.most, out.of.back().y);
}

}  // namespace

BeamStarts mesh_starts(const Mesh& mesh, const GridFrame& frame, const std::vector<GpuCutCell>& cut_cells) {
  const Owners owners(frame, cut_cells);
  const std::vector<SurfacePiece> pieces = surface_pieces(mesh, frame);
  std::vector<Group> facets(2 * cut_cells.size());
  for (const SurfacePiece& piece : pieces)
    if (const std::uint32_t entry = owners.entry(piece); entry > 1) facets[entry].add(piece);
  BeamStarts out;
  for (std::size_t i = 0; i < facets.size(); ++i) {
    std::vector<Group> groups;
    if (facets[i].area > 0) groups = groups_of(std::move(facets[i]));
    add_starts(groups, cut_cells[i / 2], i > 1 ? cut_cells[i / 2].side[i % 2] : GpuFacet{}, frame.h, out);
  }
  return out;
}

BeamStarts facet_starts(const GridFrame& frame, const std::vector<GpuCutCell>& cut_cells) {
  BeamStarts out;
  for (std::size_t i = 0; i < 2 * cut_cells.size(); ++i)
    add_starts({}, cut_cells[i / 2], i > 1 ? cut_cells[i / 2].side[i % 2] : GpuFacet{}, frame.h, out);
  return out;
}

}  // namespace alabaster
