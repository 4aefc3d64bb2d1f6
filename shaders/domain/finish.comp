// Volume, centroids and facets of the cut cells (the formulas stand in engine/domain/cut_cells.h). One thread a cut cell.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "sums.glsl"
#include "cells.glsl"
layout(local_size_x = 64) in;
layout(constant_id = 0) const int parted = 1;  // 0 where no cell gives anything
layout(push_constant, scalar) uniform Push { DomainPush push; };
layout(binding = 3, scalar) readonly buffer CutList { uint cut_list[]; };
layout(binding = 4, scalar) readonly buffer Gifts { uint gifts[]; };
layout(binding = 5, scalar) readonly buffer Faces { ivec4 faces[]; };
layout(binding = 6, scalar) writeonly buffer CutCells { GpuCutCell cut_cells[]; };
layout(binding = 7, rgba32f) uniform readonly image3D aperture_x;

float volume;
vec3 moment;    // integral x dV
Part side[2];
vec4 face[3];   // low faces: aperture, first moments
float reach = 0.0;  // a cell that takes a piece reaches into the giver

void load_cell(uint rank, ivec3 cell) {
  if (rank == none) {  // a whole cell that takes a gift
    volume = imageLoad(aperture_x, ivec3(cell.x / 4, cell.yz))[cell.x % 4] > 0.5 ? 1.0 : 0.0;
    moment = vec3(0.5 * volume);
    for (int i = 0; i < 3; ++i) face[i] = vec4(1, vec3(0.5)) * volume;
    return;
  }
  vec3 A = vec3(0), M = vec3(0), Q = vec3(0);
  for (int kind = 0; kind < 6; ++kind) {
    Part p = load_part(rank, kind);
    side[kind % 2].A += p.A;
    side[kind % 2].S += p.S;
    side[kind % 2].X += p.X;
    side[kind % 2].T += p.T;
    A += p.A;
    M += vec3(sum_of(rank, kind, sum_M), sum_of(rank, kind, sum_M + 4), sum_of(rank, kind, sum_M + 8));
    Q += sum3_of(rank, kind, sum_Q);
  }
  volume = 0.0;
  for (int i = 0; i < 3; ++i) {
    face[i] = vec4(faces[3u * rank + uint(i)]) / fixed_one;
    float high = face[i].x - A[i];
    volume += (high + M[i]) / 3.0;  // three equal values but for rounding
    moment[i] = 0.5 * high + Q[i];
  }
}

// Adds (sign 1) or takes away (-1) the piece and the sheet that cell `rank` gives, in coordinates moved by `offset`.
void move_piece(uint rank, int kind, float sign, vec3 offset) {
  Piece piece = load_piece(rank, kind);
  Part p = load_part(rank, kind);
  volume += sign * piece.volume;
  moment += sign * (piece.moment + offset * piece.volume);
  int s = kind % 2;
  side[s].A += sign * p.A;
  side[s].S += sign * p.S;
  side[s].X += sign * (p.X + offset * p.S);
  side[s].T += sign * (p.T + dot(offset, p.A));
}

void close_low_face(uint rank, int kind) {
  int i = kind / 2;
  float sign = kind % 2 == 0 ? 1.0 : -1.0;
  face[i] -= sign * vec4(sum_of(rank, kind, sum_A + i), sum3_of(rank, kind, sum_M + 3 * i));
}

void exchange_gifts(uint rank, ivec3 cell) {
  if (rank != none && gifts[rank] != 0u) {
    int kind = int(gifts[rank]) - 1;
    move_piece(rank, kind, -1.0, vec3(0));
    if (kind % 2 == 0) close_low_face(rank, kind);
  }
  for (int kind = 0; kind < 6; ++kind) {
    int toward = kind % 2 == 1 ? 1 : -1;  // where this class goes
    ivec3 giver = cell;
    giver[kind / 2] -= toward;
    uint other = candidate(giver, push.cells);
    if (other == none || gifts[other] != uint(kind + 1)) continue;
    vec3 offset = vec3(0);
    offset[kind / 2] = -float(toward);
    move_piece(other, kind, 1.0, offset);
    reach = 1.0;
    if (toward == 1) close_low_face(other, kind);
  }
}

GpuFacet make_facet(Part p, vec3 centre) {
  GpuFacet f;
  f.area = 0.0;
  f.area_vector = vec3(0);
  f.centre = vec3(0);
  f.distance = 0.0;
  if (p.S < least_facet) return f;
  f.area = p.S;
  f.area_vector = p.A;
  f.centre = p.X / p.S;
  f.distance = max(0.0, (p.T - dot(p.A, centre)) / p.S);
  return f;
}

void main() {
  uint thread = gl_GlobalInvocationID.x;
  if (thread >= push.count) return;
  ivec3 cell = cell_at(cut_list[thread], push.cells);
  uint rank = candidate(cell, push.cells);
  for (int s = 0; s < 2; ++s) side[s] = Part(vec3(0), 0.0, vec3(0), 0.0);
  load_cell(rank, cell);
  if (parted == 1) exchange_gifts(rank, cell);
  Part all = Part(side[0].A + side[1].A, side[0].S + side[1].S, side[0].X + side[1].X, side[0].T + side[1].T);
  GpuCutCell cut;
  cut.cell = cell;
  cut.volume = clamp(volume, least_volume, 1.0 + 6.0 * reach);  // more only where the mesh overlaps itself
  cut.centre = volume > least_volume ? moment / volume : all.X / max(all.S, least_facet);
  cut.centre = clamp(cut.centre, -reach, 1.0 + reach);
  cut.facet = make_facet(all, cut.centre);
  for (int s = 0; s < 2; ++s) cut.side[s] = make_facet(side[s], cut.centre);
  for (int i = 0; i < 3; ++i) {
    vec3 c = face[i].x < face_snap ? vec3(0.5) : clamp(face[i].yzw / face[i].x, 0.0, 1.0);
    c[i] = 0.0;
    cut.low_face_centre[i] = c;
  }
  cut_cells[thread + 1u] = cut;
}
