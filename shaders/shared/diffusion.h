// What the diffusion solver's shaders and its C++ side agree on.
//
// Layout. A quantity of the grid is a 3D image of rgba32f texels: texel (x4, y, channel * nz + z) holds the four cells
// x = 4 x4 .. 4 x4 + 3. Quantities with several entries a cell stack them along x: texel x = entry * nx4 + x4, with
// nx4 = ceil(nx / 4). Reads outside an image are zero and writes there are dropped (robustImageAccess).
//
// Scale. Everything inside is without units: lengths in h, kappa in the channel's largest kappa, fluence in the channel's
// largest boundary value 4 Gamma_s / F_dt; so neither metres, millimetres nor the strength of the light reach fp32's ends.
#ifndef ALABASTER_SHARED_DIFFUSION_H
#define ALABASTER_SHARED_DIFFUSION_H
#include "language.h"

// Entries of the finest stencil: conductances of the faces towards lower x, y, z, and the reaction (absorption and what
// the surface lets through). (A phi)_i = reaction_i phi_i + sum_f T_f (phi_i - phi_j): differences, so that a constant
// field loses nothing to rounding.
#define DIFFUSION_REACTION 3
#define DIFFUSION_FINEST_ENTRIES 4
// Entries of a coarse stencil: A(i, i + offset(k)), k = 0..13, offset(k) = (k % 3, k / 3 % 3, k / 9) - 1; the other
// thirteen are these by symmetry. Entry 13 is the row's sum, not its diagonal: where strong couplings meet weak ones the
// sum is what a diagonal in single precision has lost. (A x)_i = sum_i x_i + sum_j a_ij (x_j - x_i), as on the finest.
#define DIFFUSION_ROW_SUM 13
#define DIFFUSION_COARSE_ENTRIES 14
#define DIFFUSION_WEIGHTS 27
// What the cycle reads of the finest stencil: two bf16 numbers in a word, low half first, four words a texel as
// everywhere. Entries 0..2: conductances of the faces towards lower and upper x, y, z; entry 3: the reaction and the
// reciprocal l1 norm of the row. Both sides of a face round alike, so the preconditioner stays symmetric, and positive
// numbers within 1/256 of the stencil's are as good; the conjugate gradients' own operator stays in single precision.
// Coarse stencils have couplings of both signs, which cancel: rounded to bf16, cycles at contrast 1e6 broke down.
#define DIFFUSION_PAIRS 4
// Of the diagonal: couplings below this are none to interpolate by.
#define DIFFUSION_CONNECTED 1e-7

// Islands (engine/diffusion/islands.h): an entry is x | y << 9 | z << 18 | kind << 27 of a cell of the island; kinds 0 to 5
// are its face towards -x, +x, -y, +y, -z, +z, beyond which the island ends.
#define DIFFUSION_ISLAND_CELLS 512
#define DIFFUSION_ISLAND_CELL 6
#define DIFFUSION_ISLAND_PIECE 4096
// How rough a medium is (rough.comp): a cell lies at a jump where one of its faces conducts so many times another, and
// in noise where they are of three magnitudes, each so many times the one before.
#define DIFFUSION_JUMP 30.0f
#define DIFFUSION_MAGNITUDE 8.0f

// Work goes by bricks of 2 x 4 x 1 texels, so 8 x 4 x 1 cells: x | y << 10 | z << 20, counted in bricks. Lists of them
// fill whole workgroups: DIFFUSION_NO_BRICK lies beyond every grid.
#define DIFFUSION_BRICK_X 2
#define DIFFUSION_BRICK_Y 4
#define DIFFUSION_NO_BRICK 0xffffffffu
// On the finest level passes with a stencil walk up columns of bricks, which keeps three layers at hand: x | y << 7 |
// z << 15 of the lowest brick | bricks << 25. None where there are no bricks.
#define DIFFUSION_COLUMN_BRICKS 16
// Invocations of a workgroup, eight a brick. Dot products: each subgroup (of 8 or more) leaves one partial sum, for which
// there is room for one a brick.
#define DIFFUSION_GROUP 128
#define DIFFUSION_PARTIALS 16

// Tables of the cut cells are images this wide, of as many rows as that takes. That of points (points.comp), lengths in h:
// layer 0 the cell's centroid and its volume; 1 to 3 the centroids of its faces towards lower x, y, z, each with that
// coordinate of the cell; then of its facet the place beside the normal through the cell's centroid, with the share of
// the upper side in its area, and the normal, with the facet's height above the centroid. A bent facet has neither.
#define DIFFUSION_TABLE_WIDTH 1024
#define DIFFUSION_POINT_LAYERS 6
#define DIFFUSION_POINT_BESIDE 4
#define DIFFUSION_POINT_NORMAL 5

// What reduce.comp makes of the sums.
#define DIFFUSION_REDUCE_START 0
#define DIFFUSION_REDUCE_BETA 1
#define DIFFUSION_REDUCE_ALPHA 2
#define DIFFUSION_REDUCE_RESIDUAL 3
#define DIFFUSION_REDUCE_TRUE 4
#define DIFFUSION_REDUCE_SCALED 5
#define DIFFUSION_REDUCE_SIZE 6
// The scaled residual |D^-1 r| / |x| may be as many times the tolerance; the fluence's error is some 40 times it.
#define DIFFUSION_SCALED 3.0f

ALABASTER_BEGIN_SHARED

struct LevelPush {
  ivec3 cells;         // of the level; in transfers and set-up of the finer one
  ivec3 coarse_cells;  // of the next coarser level
  float omega;         // smoothing factor
  float step;          // of x, in blend.comp
};

struct WeightsPush {
  ivec3 cells;         // of the finer level
  ivec3 coarse_cells;  // of the coarser one
  int first;           // of the entries that a dispatch makes (weights.comp)
};

struct ReducePush {
  int partials;  // of one channel
  int mode;      // DIFFUSION_REDUCE_*
  int first;     // of the sums' partials; later ones are of other sums
};

struct IslandPush {
  ivec3 cells;
  uint pieces;  // of the islands of all channels
};

struct LiftPush {
  uint islands;  // of all channels
};

// Scalars of the conjugate gradients of one channel.
struct CgScalars {
  float tolerance;     // of the relative residual and of the scaled one; the host sets it
  float target;        // relative residual by recurrence at which to look at the true one; the host sets it
  float bb;            // |b|^2
  float rr;            // |r|^2, r by recurrence
  float rho;           // r . z
  float alpha;         // step; 0 once converged
  float beta;
  float true_rr;       // |b - A x|^2
  float scaled_rr;     // |D^-1 (b - A x)|^2, D the l1 norm of the rows
  float xx;            // |x|^2
  int iterations;
  int done;            // 1: converged, 2: broken down (p . A p <= 0 or not finite)
};

// Cells of one channel, counted. The surface cuts faces down to nothing in any medium: cells within have six faces, and
// deep ones neighbours that have six as well, so that no face of theirs is cut.
struct Roughness {
  uint all;
  uint within, jumps, noisy;
  uint deep, deep_jumps;
};

// A part of an island, from entry `begin` to before `end`.
struct IslandPiece {
  uint begin, end;
  int channel;
};

// An island is the pieces from `begin` to before `end`.
struct IslandPieces {
  uint begin, end;
  float weight;  // 1 / E of the island
};

// The medium at a cut cell, for the surface.
struct FacetMedium {
  vec3 kappa;              // m
  vec3 reduced_intensity;  // exp(-sigma_a / sigma_s')
  vec3 sigma_a;            // 1/m
};

// A cell near the surface, and which cut cells are around it: near_surface.h.
struct NearCell {
  uint cell;         // x | y << 10 | z << 20
  uint begin, end;   // of its neighbours
  float alike;       // how far the two sides of the surface around it face the same way, 0 to 1
  float alike_here;  // the same of the surface in the cell itself
};

// Unit of a channel's fluence inside the solver.
struct FluenceScale {
  float unit;   // W/m^2: the power of two above the largest boundary value 4 Gamma_s / F_dt
  float ratio;  // unit of the solve before over this one; 0 where there is nothing to keep
};

struct OperatorPush {
  ivec3 cells;
  int count;        // of cut cells, entry 0 included
  vec3 resistance;   // A kappa_scale / h of each channel
  vec3 kappa_scale;  // m
};

struct SourcePush {
  ivec3 cells;
  int count;       // of cut cells, entry 0 included
  int rim_cells;   // engine/diffusion/rim.h
  int rim_texels;
  vec3 per_power;  // 1 / (h kappa_scale) of each channel, 1/m^2
};

struct SurfacePush {
  ivec3 cells;
  int count;     // of cut cells, entry 0 included
  int channels;  // 1 or 3
  float A;
  float f_dt;
  float h;       // m
  int sides;     // Gamma_s entries a cut cell in surface.comp: 2, one for each side of its surface, or 1 for both
};

// Per channel, in units: light in and out in W, absorbed still in units of the solver.
struct EnergySums {
  float in_, absorbed, out_;
};

ALABASTER_END_SHARED

#endif
