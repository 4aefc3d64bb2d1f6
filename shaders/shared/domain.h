// What the domain room hands on, one layout for GLSL and C++ (scalar block layout). Definitions: engine/domain/cut_cells.h.
#ifndef ALABASTER_SHARED_DOMAIN_H
#define ALABASTER_SHARED_DOMAIN_H
#include "language.h"

ALABASTER_BEGIN_SHARED

// A part of the surface in a cell, in cell-local units: h = 1, positions from the cell's low corner.
struct GpuFacet {
  float area;        // h^2
  vec3 area_vector;  // h^2, outward; its length is below `area` where the surface bends
  vec3 centre;       // h
  float distance;    // h, >= 0: mean depth of the cell's centroid below the surface
};

// A cell that holds a part of the surface. Entry 0 of the buffer is a plain inner cell (volume 1, centroids in the
// middle, no facet), so that a cell without surface, whose index is 0, can be read like any other.
struct GpuCutCell {
  ivec3 cell;
  float volume;                // h^3, > 0; above 1 where a neighbour gave the piece beyond a slit
  vec3 centre;                 // h, of the solid part
  GpuFacet facet;              // all of the surface in the cell
  GpuFacet side[2];            // the same, parted: normals mainly up an axis, mainly down one
  vec3 low_face_centre[3];     // h, of the wetted part of the faces towards lower x, y, z
};

// Counters of the passes.
struct DomainStatus {
  uint closure;            // 2^-24 h^2: largest aperture left at the far end of a row
  uint slit_cells;
  uint crumpled_cells;     // with more surface than the sums hold
  uint inner_cells;
  uint overlapping_texels;  // with an aperture above 1
  uint inverted_texels;     // with one below 0
  uint pairs, pairs_listed;  // of a triangle and a cell
};

struct DomainPush {
  ivec3 cells;
  uint count;  // threads with work
};

ALABASTER_END_SHARED

#endif
