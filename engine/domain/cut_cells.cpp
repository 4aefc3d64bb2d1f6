#include "domain/cut_cells.h"

#include <algorithm>
#include <cmath>

namespace alabaster {

namespace {

constexpr double face_snap = 1e-5;     // h^2: apertures nearer than this to 0 or 1 are 0 or 1
constexpr double least_volume = 1e-6;  // h^3: of a cell that holds surface
constexpr double least_facet = 1e-7;   // h^2: smaller facets are dropped
constexpr double least_sheet = 2e-4;   // h^2: smaller sheets make no slit

/// Integrals over pieces of the surface in one cell; x is the position from the cell's low corner, A = n dA.
struct Sums {
  glm::dvec3 A{0};                // integral n dA
  double S = 0;                   // integral dA
  glm::dvec3 X{0};                // integral x dA
  std::array<glm::dvec3, 3> M{};  // M[i][j] = integral n_i x_j dA
  glm::dvec3 Q{0};                // Q[i] = integral n_i x_i^2 / 2 dA

  double trace() const { return M[0].x + M[1].y + M[2].z; }
};

using Classes = std::array<Sums, 6>;  // see facet_class()

struct Polygon {
  std::array<glm::dvec3, 10> corner;
  int count = 0;
  void add(glm::dvec3 p) { corner[count++] = p; }
};

/// The part of `in` with sign * (x_axis - plane) <= 0.
Polygon clip(const Polygon& in, int axis, double plane, double sign) {
  Polygon out;
  for (int c = 0; c < in.count; ++c) {
    glm::dvec3 a = in.corner[c], b = in.corner[(c + 1) % in.count];
    double da = sign * (a[axis] - plane), db = sign * (b[axis] - plane);
    if (da <= 0) out.add(a);
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
      glm::dvec3 p = a + (b - a) * (da / (da - db));
      p[axis] = plane;
      out.add(p);
    }
  }
  return out;
}

void add_polygon(Sums& sums, const Polygon& polygon, glm::dvec3 normal) {
  for (int t = 1; t + 1 < polygon.count; ++t) {
    glm::dvec3 a = polygon.corner[0], b = polygon.corner[t], c = polygon.corner[t + 1];
    glm::dvec3 A = 0.5 * glm::cross(b - a, c - a), centre = (a + b + c) / 3.0;
    double S = glm::dot(A, normal);
    sums.A += A;
    sums.S += S;
    sums.X += S * centre;
    for (int i = 0; i < 3; ++i) sums.M[i] += A[i] * centre;
    sums.Q += A * (a * a + b * b + c * c + a * b + b * c + c * a) / 12.0;
  }
}

/// Cells along `axis` that a triangle meets; one that lies in a grid plane belongs to the cell on its inner side.
std::array<int, 2> cell_range(const Polygon& triangle, int axis, double normal) {
  double low = triangle.corner[0][axis], high = low;
  for (int c = 1; c < 3; ++c) {
    low = std::min(low, triangle.corner[c][axis]);
    high = std::max(high, triangle.corner[c][axis]);
  }
  if (low == high && low == std::floor(low)) {
    int cell = int(low) - (normal > 0 ? 1 : 0);
    return {cell, cell};
  }
  return {int(std::floor(low)), int(std::ceil(high)) - 1};
}

/// Each triangle clipped to each cell that it meets: visit(cell, polygon, unit normal).
template <class Visit>
void for_each_polygon(const Mesh& mesh, const GridFrame& frame, const Visit& visit) {
  const std::vector<glm::vec3> positions = grid_positions(mesh, frame);
  for (glm::uvec3 t : mesh.triangles) {
    Polygon triangle;
    for (int c = 0; c < 3; ++c) triangle.add(positions[t[c]]);
    const auto& p = triangle.corner;
    glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
    if (normal == glm::dvec3(0)) continue;
    normal = glm::normalize(normal);
    const auto rx = cell_range(triangle, 0, normal.x), ry = cell_range(triangle, 1, normal.y),
               rz = cell_range(triangle, 2, normal.z);
    if (rx[0] == rx[1] && ry[0] == ry[1] && rz[0] == rz[1]) {
      visit(glm::ivec3(rx[0], ry[0], rz[0]), triangle, normal);
      continue;
    }
    for (int z = rz[0]; z <= rz[1]; ++z) {
      const Polygon in_z = clip(clip(triangle, 2, z, -1), 2, z + 1, 1);
      for (int y = ry[0]; y <= ry[1] && in_z.count > 2; ++y) {
        const Polygon in_y = clip(clip(in_z, 1, y, -1), 1, y + 1, 1);
        for (int x = rx[0]; x <= rx[1] && in_y.count > 2; ++x) {
          const Polygon piece = clip(clip(in_y, 0, x, -1), 0, x + 1, 1);
          if (piece.count > 2) visit(glm::ivec3(x, y, z), piece, normal);
        }
      }
    }
  }
}

/// What a cell gives away where a slit runs through it: a sheet and the piece behind it, to the next cell along `axis`.
struct Gift {
  int axis = -1;
  int direction = 0;     // +1 or -1
  int facet_class = 0;   // which part of its surface
  double area = 0;       // h^2 that the face between giver and taker loses
  double volume = 0;     // h^3
  glm::dvec3 moment{0};  // integral x dV of the piece given, giver's coordinates
};

/// The gift of a cell in which solid ends, and beyond a gap solid begins, along an axis; axis -1 for any other cell.
Gift find_gift(const Classes& classes) {
  Gift gift;
  double widest = least_sheet;
  for (int axis = 0; axis < 3; ++axis) {
    const Sums &end = classes[2 * axis], &begin = classes[2 * axis + 1];  // facing up, facing down the axis
    double narrower = std::min(end.A[axis], -begin.A[axis]);
    if (narrower <= widest) continue;
    double end_at = end.M[axis][axis] / end.A[axis], begin_at = begin.M[axis][axis] / begin.A[axis];
    if (begin_at <= end_at) continue;  // a plate: the solid is between the sheets
    widest = narrower;
    gift.axis = axis;
    gift.direction = end_at + begin_at > 1 ? 1 : -1;  // the smaller piece goes
  }
  if (gift.axis < 0) return gift;
  int i = gift.axis;
  gift.facet_class = 2 * i + (gift.direction > 0 ? 1 : 0);
  const Sums& s = classes[gift.facet_class];
  double high_face = gift.direction > 0 ? s.A[i] : 0;
  gift.area = std::abs(s.A[i]);
  gift.volume = std::max(0.0, s.M[i][i] - high_face);
  gift.moment = gift.volume * s.X / s.S;
  gift.moment[i] = s.Q[i] - 0.5 * high_face;
  return gift;
}

struct Solid {  // of one cell, after gifts
  double volume = 0;
  glm::dvec3 moment{0};  // integral x dV
  Classes classes;
  double reach = 0;  // h: a cell that takes a piece reaches into the giver
};

Sums shifted(Sums s, int axis, double by) {  // to coordinates x + by e_axis
  s.X[axis] += by * s.S;
  for (int i = 0; i < 3; ++i) s.M[i][axis] += by * s.A[i];
  return s;
}

class Cutter {
 public:
  Cutter(const Mesh& mesh, const GridFrame& frame) {
    out_.frame = frame;
    std::size_t n = std::size_t(frame.cells.x) * frame.cells.y * frame.cells.z;
    out_.volume.assign(n, 0);
    for (auto& a : out_.aperture) a.assign(n, 0);
    for (auto& m : moment_) m.assign(n, glm::dvec3(0));
    out_.cut_index.assign(n, -1);
    slot_.assign(n, -1);
    stride_ = {1, std::size_t(frame.cells.x), std::size_t(frame.cells.x) * frame.cells.y};
    for_each_polygon(mesh, frame, [this](glm::ivec3 cell, const Polygon& piece, glm::dvec3 normal) {
      add_piece(cell, piece, normal);
    });
  }

  CutCells cut() {
    for (int axis = 0; axis < 3; ++axis) sweep(axis);
    make_solids();
    part_slits();
    finish();
    return std::move(out_);
  }

 private:
  void add_piece(glm::ivec3 cell, Polygon piece, glm::dvec3 normal) {
    for (int c = 0; c < piece.count; ++c) piece.corner[c] -= glm::dvec3(cell);
    add_polygon(sums_of(out_.index(cell))[facet_class(normal)], piece, normal);
  }

  Classes& sums_of(std::size_t at) {
    if (slot_[at] < 0) {
      slot_[at] = int(sums_.size());
      sums_.emplace_back();
    }
    return sums_[slot_[at]];
  }

  /// Apertures and first moments of the faces across `axis`: running sums from the empty margin.
  void sweep(int axis) {
    glm::ivec3 cells = out_.frame.cells;
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    glm::ivec3 cell;
    for (cell[v] = 0; cell[v] < cells[v]; ++cell[v]) {
      for (cell[u] = 0; cell[u] < cells[u]; ++cell[u]) {
        double a = 0;
        glm::dvec3 m{0};
        for (cell[axis] = 0; cell[axis] < cells[axis]; ++cell[axis]) {
          std::size_t at = out_.index(cell);
          out_.aperture[axis][at] = a;
          moment_[axis][at] = m;
          if (slot_[at] < 0) continue;
          for (const Sums& s : sums_[slot_[at]]) a -= s.A[axis], m -= s.M[axis];
        }
        out_.worst_closure = std::max(out_.worst_closure, std::abs(a));
      }
    }
  }

  void make_solids() {
    solids_.resize(sums_.size());
    for (std::size_t at = 0; at < slot_.size(); ++at) {
      if (slot_[at] < 0) {
        out_.volume[at] = out_.aperture[0][at] > 0.5 ? 1 : 0;
        continue;
      }
      Solid& solid = solids_[slot_[at]];
      solid.classes = sums_[slot_[at]];
      for (int i = 0; i < 3; ++i) {
        double high = out_.aperture[i][at + stride_[i]], M = 0, Q = 0;
        for (const Sums& s : solid.classes) M += s.M[i][i], Q += s.Q[i];
        solid.volume += (high + M) / 3;  // three equal values but for rounding
        solid.moment[i] = 0.5 * high + Q;
      }
    }
  }

  void part_slits() {
    std::vector<std::pair<std::size_t, Gift>> gifts;
    for (std::size_t at = 0; at < slot_.size(); ++at) {
      if (slot_[at] < 0) continue;
      Gift gift = find_gift(sums_[slot_[at]]);
      if (gift.axis >= 0) gifts.push_back({at, gift});
    }
    out_.slit_cells = int(gifts.size());
    std::vector<FaceOf> closed = faces_between_pieces(gifts);
    for (auto& [at, gift] : gifts) {
      std::size_t to = gift.direction > 0 ? at + stride_[gift.axis] : at - stride_[gift.axis];
      if (slot_[to] < 0) {
        slot_[to] = int(solids_.size());
        solids_.push_back(
            {.volume = out_.volume[to], .moment = glm::dvec3(0.5 * out_.volume[to]), .classes = {}, .reach = 0});
      }
      Solid &giver = solids_[slot_[at]], &taker = solids_[slot_[to]];
      const Sums& given = sums_[slot_[at]][gift.facet_class];
      Sums moved = shifted(given, gift.axis, -gift.direction);
      giver.volume -= gift.volume;
      giver.moment -= gift.moment;
      subtract(giver.classes[gift.facet_class], given);
      taker.reach = 1;
      taker.volume += gift.volume;
      glm::dvec3 moment = gift.moment;
      moment[gift.axis] -= gift.direction * gift.volume;
      taker.moment += moment;
      add(taker.classes[gift.facet_class], moved);
      std::size_t face = gift.direction > 0 ? to : at;
      double sign = given.A[gift.axis] > 0 ? 1 : -1;
      out_.aperture[gift.axis][face] -= gift.area;
      moment_[gift.axis][face] -= sign * given.M[gift.axis];
    }
    for (const FaceOf& f : closed) out_.aperture[f.axis][f.upper] = 0, moment_[f.axis][f.upper] = glm::dvec3(0);
  }

  struct FaceOf {
    int axis;
    std::size_t upper;  // the cell whose low face it is
  };

  /// Faces that would join the pieces on the two sides of a slit: a giver keeps one piece, and
  /// - two givers that keep opposite pieces are not joined,
  /// - nor is a giver joined to another cell through a face that lies on the side of the piece given away.
  std::vector<FaceOf> faces_between_pieces(const std::vector<std::pair<std::size_t, Gift>>& gifts) const {
    std::vector<FaceOf> closed;
    std::vector<int> given(sums_.size(), -1);  // class that a slot gives
    for (const auto& [at, gift] : gifts) given[slot_[at]] = gift.facet_class;
    for (const auto& [at, gift] : gifts) {
      const Sums &gone = sums_[slot_[at]][gift.facet_class], &kept = sums_[slot_[at]][gift.facet_class ^ 1];
      for (int face = 0; face < 6; ++face) {
        int axis = face / 2, up = face % 2;
        std::size_t upper = up ? at + stride_[axis] : at, other = up ? upper : at - stride_[axis];
        int other_given = slot_[other] < 0 || slot_[other] >= int(sums_.size()) ? -1 : given[slot_[other]];
        if (other_given >= 0) {
          if (glm::dot(kept.A, sums_[slot_[other]][other_given ^ 1].A) < 0) closed.push_back({axis, upper});
          continue;
        }
        double a = out_.aperture[axis][upper];
        glm::dvec3 c = a < face_snap ? glm::dvec3(0.5) : moment_[axis][upper] / a;
        c[axis] = up;
        if (behind(c, gone) && !behind(c, kept)) closed.push_back({axis, upper});
      }
    }
    return closed;
  }

  static bool behind(glm::dvec3 x, const Sums& sheet) { return glm::dot(x - sheet.X / sheet.S, sheet.A) < 0; }

  static void add(Sums& s, const Sums& o) { combine(s, o, 1); }
  static void subtract(Sums& s, const Sums& o) { combine(s, o, -1); }
  static void combine(Sums& s, const Sums& o, double factor) {
    s.A += factor * o.A;
    s.S += factor * o.S;
    s.X += factor * o.X;
    for (int i = 0; i < 3; ++i) s.M[i] += factor * o.M[i];
  }

  static Facet make_facet(const Sums& s, glm::dvec3 centroid) {
    if (s.S < least_facet) return {};
    return {s.S, s.A, s.X / s.S, std::max(0.0, (s.trace() - glm::dot(s.A, centroid)) / s.S)};
  }

  void finish() {
    glm::ivec3 cells = out_.frame.cells;
    for (std::size_t at = 0; at < slot_.size(); ++at) {
      if (slot_[at] < 0) continue;
      const Solid& solid = solids_[slot_[at]];
      std::array<Sums, 2> sides;
      for (int c = 0; c < 6; ++c) add(sides[c % 2], solid.classes[c]);
      Sums all = sides[0];
      add(all, sides[1]);
      if (all.S < least_facet) {
        out_.volume[at] = solid.volume > 0.5 ? 1 : 0;
        continue;
      }
      CutCell cut;
      cut.cell = {int(at % cells.x), int(at / cells.x % cells.y), int(at / stride_[2])};
      double most = 1 + 6 * solid.reach;  // more only where the mesh overlaps itself
      cut.volume = std::clamp(solid.volume, least_volume, most);
      cut.centroid = solid.volume > least_volume ? solid.moment / solid.volume : all.X / all.S;
      cut.centroid = glm::clamp(cut.centroid, -solid.reach, 1 + solid.reach);
      cut.facet = make_facet(all, cut.centroid);
      for (int s = 0; s < 2; ++s) cut.side[s] = make_facet(sides[s], cut.centroid);
      for (int i = 0; i < 3; ++i) cut.low_face_centroid[i] = face_centroid(at, i);
      out_.volume[at] = cut.volume;
      out_.cut_index[at] = int(out_.cut_cells.size());
      out_.cut_cells.push_back(cut);
    }
    for (auto& aperture : out_.aperture) {
      for (double& a : aperture) a = a < face_snap ? 0 : a > 1 - face_snap ? 1 : a;
    }
  }

  glm::dvec3 face_centroid(std::size_t at, int axis) const {
    double a = out_.aperture[axis][at];
    glm::dvec3 c = a < face_snap ? glm::dvec3(0.5) : glm::clamp(moment_[axis][at] / a, 0.0, 1.0);
    c[axis] = 0;
    return c;
  }

  CutCells out_;
  std::array<std::vector<glm::dvec3>, 3> moment_;  // h^3, of low faces
  std::vector<int> slot_;                          // of a cell in sums_ and solids_, -1 for cells without surface
  std::vector<Classes> sums_;
  std::vector<Solid> solids_;
  std::array<std::size_t, 3> stride_{};
};

}  // namespace

CutCells cut_cells(const Mesh& mesh, const GridFrame& frame) { return Cutter(mesh, frame).cut(); }

std::vector<SurfacePiece> surface_pieces(const Mesh& mesh, const GridFrame& frame) {
  std::vector<SurfacePiece> pieces;
  for_each_polygon(mesh, frame, [&](glm::ivec3 cell, const Polygon& polygon, glm::dvec3 normal) {
    Sums sums;
    add_polygon(sums, polygon, normal);
    if (sums.S > 0) pieces.push_back({cell, sums.S, sums.X / sums.S, normal});
  });
  return pieces;
}

glm::dvec3 CutCells::centroid(glm::ivec3 cell) const {
  const CutCell* cut = find(cell);
  return cut ? cut->centroid : glm::dvec3(0.5);
}

glm::dvec3 CutCells::low_face_centroid(glm::ivec3 cell, int axis) const {
  const CutCell* cut = find(cell);
  glm::dvec3 c = cut ? cut->low_face_centroid[axis] : glm::dvec3(0.5);
  c[axis] = 0;
  return c;
}

double CutCells::total_volume() const {
  double sum = 0, h = frame.h;
  for (double v : volume) sum += v;
  return sum * h * h * h;
}

double CutCells::total_area() const {
  double sum = 0, h = frame.h;
  for (const CutCell& c : cut_cells) sum += c.facet.area;
  return sum * h * h;
}

glm::dvec3 CutCells::area_vector() const {
  glm::dvec3 sum{0};
  double h = frame.h;
  for (const CutCell& c : cut_cells) sum += c.facet.area_vector;
  return sum * h * h;
}

std::size_t CutCells::inner_cells() const {
  std::size_t count = 0;
  for (std::size_t at = 0; at < volume.size(); ++at) count += volume[at] == 1 && cut_index[at] < 0;
  return count;
}

}  // namespace alabaster
