// Reading a candidate cell's sums back, and the gifts across slits (twin: find_gift in engine/domain/cut_cells.cpp).
layout(binding = 0, scalar) readonly buffer Bits { uint bits[]; };      // candidates: cells that a triangle may meet
layout(binding = 1, scalar) readonly buffer Before { uint before[]; };
layout(binding = 2, scalar) readonly buffer Sums { int sums[]; };

const uint none = 0xffffffffu;

uint candidate(ivec3 cell, ivec3 cells) {  // its rank, or none
  uint c = cell_index(cell, cells), word = bits[c >> 5];
  return (word >> (c & 31u) & 1u) != 0u ? rank_of(word, before[c >> 5], c & 31u) : none;
}

float sum_of(uint rank, int kind, int which) {
  return float(sums[(6u * rank + uint(kind)) * sum_count + uint(which)]) / fixed_one;
}
vec3 sum3_of(uint rank, int kind, int which) {
  return vec3(sum_of(rank, kind, which), sum_of(rank, kind, which + 1), sum_of(rank, kind, which + 2));
}

struct Part {  // of the surface: integrals n dA, dA, x dA, n.x dA
  vec3 A;
  float S;
  vec3 X;
  float T;
};

Part load_part(uint rank, int kind) {
  Part p;
  p.A = sum3_of(rank, kind, sum_A);
  p.S = sum_of(rank, kind, sum_S);
  p.X = sum3_of(rank, kind, sum_X);
  p.T = sum_of(rank, kind, sum_M) + sum_of(rank, kind, sum_M + 4) + sum_of(rank, kind, sum_M + 8);
  return p;
}

// A gift is named by 1 + the class given, 0 for none: class 2 * axis goes down the axis, 2 * axis + 1 goes up.
struct Piece {
  float volume;
  vec3 moment;  // integral x dV, in the giver's coordinates
};

Piece load_piece(uint rank, int kind) {
  int i = kind / 2;
  float high_face = kind % 2 == 1 ? sum_of(rank, kind, sum_A + i) : 0.0;
  Piece p;
  p.volume = max(0.0, sum_of(rank, kind, sum_M + 4 * i) - high_face);
  p.moment = p.volume * sum3_of(rank, kind, sum_X) / sum_of(rank, kind, sum_S);
  p.moment[i] = sum_of(rank, kind, sum_Q + i) - 0.5 * high_face;
  return p;
}
