// Cut cells of a closed triangle mesh, in double precision: the plain twin of the compute shaders in shaders/domain/.
//
// Everything follows, exactly and without an inside test, from integrals over the pieces of the mesh in each cell (each
// triangle clipped to the cell) by the divergence theorem. In cell-local units (h = 1, coordinates from the cell's low
// corner), with n the outward normal and i an axis:
//   closed surface of the cell's solid part  a_i(high) = a_i(low) - integral n_i dA    apertures: prefix sums along i
//   div (x_i e_i) = 1                        V = a_i(high) + integral n_i x_i dA
//   div (x_i^2/2 e_i) = x_i                  V c_i = a_i(high)/2 + integral n_i x_i^2/2 dA
//   closed surface, weighted by x_j          m_ij(high) = m_ij(low) - integral n_i x_j dA   wetted faces' moments
// A piece that lies in a grid plane belongs to the cell on its inner side.
//
// Two sheets with a gap between them in one cell (a slit thinner than a cell) would join the solids on both sides.
// There the smaller piece, with its sheet, is given to the neighbour behind it along the axis nearest to the sheets'
// normals, and the faces that would join the two solids are closed (faces_between_pieces() in the .cpp). A taker's
// volume may exceed 1. Volume and area are kept; conduction along the slit, within a cell of it, is not exact. A plate
// thinner than a cell (the solid between the sheets) needs no care.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "domain/grid_frame.h"
#include "scene/scene.h"

namespace alabaster {

/// A part of the surface in a cell. Cell-local units.
struct Facet {
  double area = 0;            // h^2
  glm::dvec3 area_vector{0};  // h^2, outward; its length is below `area` where the surface bends
  glm::dvec3 centroid{0};     // h, from the cell's low corner
  double distance = 0;  // h, >= 0: mean depth of the cell's centroid below the surface, integral n.(x - c) dA / area
};

/// A cell that holds a part of the surface. Cell-local units.
struct CutCell {
  glm::ivec3 cell{0};
  double volume = 0;          // h^3, > 0
  glm::dvec3 centroid{0};     // h, of the solid part
  Facet facet;                // all of the surface in the cell
  std::array<Facet, 2> side;  // the same, parted: normals mainly up an axis, mainly down one; see facet_class()
  std::array<glm::dvec3, 3> low_face_centroid;  // h, of the wetted part of the face towards lower x, y, z
};

/// All of a mesh's cells. Dense arrays run x fastest, then y, then z: see index().
struct CutCells {
  GridFrame frame;
  std::vector<double> volume;                   // h^3: 0 outside, 1 inside, else the cut cell's
  std::array<std::vector<double>, 3> aperture;  // h^2: open part of the face between a cell and its lower neighbour
  std::vector<int> cut_index;                   // into cut_cells, -1 for cells without surface
  std::vector<CutCell> cut_cells;               // in the order of index()
  double worst_closure = 0;  // h^2: largest |aperture| left at the far end of a row; above 1e-4 the mesh is open
  int slit_cells = 0;        // cells whose two sheets were given to two cells

  std::size_t index(glm::ivec3 cell) const {
    return cell.x + std::size_t(frame.cells.x) * (cell.y + std::size_t(frame.cells.y) * cell.z);
  }
  const CutCell* find(glm::ivec3 cell) const {  // null for cells without surface
    int c = cut_index[index(cell)];
    return c < 0 ? nullptr : &cut_cells[c];
  }
  glm::dvec3 centroid(glm::ivec3 cell) const;                     // h, (1/2, 1/2, 1/2) without surface
  glm::dvec3 low_face_centroid(glm::ivec3 cell, int axis) const;  // h, from the cell's own low corner

  double total_volume() const;      // m^3
  double total_area() const;        // m^2
  glm::dvec3 area_vector() const;   // m^2: 0 for a closed mesh
  std::size_t inner_cells() const;  // whole cells
};

/// Parts the surface in a cell in six: 2 * (axis nearest to the normal) + (1 where the normal points down that axis).
/// The parity is the facet's side, so that the two sheets of a thin part stay apart.
inline int facet_class(glm::dvec3 normal) {
  glm::dvec3 size = glm::abs(normal);
  const double slack = 0.9999;  // ties go to the first axis, and rounding does not decide
  int axis = size.x >= slack * size.y && size.x >= slack * size.z ? 0 : size.y >= slack * size.z ? 1 : 2;
  return 2 * axis + (normal[axis] < 0 ? 1 : 0);
}

/// Cuts the grid with the mesh (vertices rounded as in grid_positions()). Exact to rounding for a closed mesh that does
/// not overlap itself; where it does, volumes and apertures are clamped.
CutCells cut_cells(const Mesh& mesh, const GridFrame& frame);

/// A triangle's part in a cell.
struct SurfacePiece {
  glm::ivec3 cell{0};
  double area = 0;         // h^2
  glm::dvec3 centroid{0};  // h, from the grid's corner
  glm::dvec3 normal{0};    // unit, outward
};

/// All of them, in the order of the triangles.
std::vector<SurfacePiece> surface_pieces(const Mesh& mesh, const GridFrame& frame);

}  // namespace alabaster
