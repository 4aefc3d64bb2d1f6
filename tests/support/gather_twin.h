// The double-precision twin of shading/gather_ray.glsl: all triangles are tried for a ray's end.
#pragma once

#include <algorithm>
#include <vector>

#include "domain/cut_cells.h"
#include "shading/gather_closure.h"
#include "shading/gather_exit.h"
#include "support/diffusion_device.h"

namespace alabaster {

class GatherTwin {
 public:
  struct Gathered {
    glm::dvec3 all{0}, single{0};
  };

  GatherTwin(gpu::Context& context, Body& body, const GatherExit& gather, const Mesh& mesh, double eta)
      : eta_(eta),
        A_(boundary_constant<double>(internal_diffuse_reflectance<double>(eta))),
        f_dt_(1 - internal_diffuse_reflectance<double>(eta)),
        n_(body.domain().frame.cells),
        h_(body.domain().frame.h),
        cuts_(body.cut_cells()),
        cut_index_(gpu::download<std::uint32_t>(context, body.domain().cut_index)),
        volume_(gpu::download<float>(context, body.domain().volume)),
        kappa_(gpu::download<float>(context, body.diffusion().kappa())),
        absorption_(gpu::download<float>(context, body.diffusion().absorption())),
        scale_(body.diffusion().kappa_scale()),
        fluence_(gpu::download<glm::vec4>(context, gather.fluence())),
        shift_(gpu::download<glm::vec4>(context, gather.shift())) {
    for (const std::uint32_t texel : gpu::download<std::uint32_t>(context, gather.unscattered()))
      unscattered_.push_back(glm::unpackUnorm4x8(texel));
    for (int s = 0; s < 2; ++s) {
      near_[s] = gpu::download<glm::vec4>(context, gather.near(s));
      field_[s] = gpu::download<glm::vec4>(context, body.diffusion().surface(s));
      drive_[s] = gpu::download<glm::vec4>(context, body.diffusion().surface_gamma(s));
    }
    const GatherClosures closures(eta);
    closures_ = closures.table();
    exits_ = closures.exits();
    const glm::dvec3 origin = body.domain().frame.origin;
    for (const glm::uvec3& t : mesh.triangles) {
      std::array<glm::dvec3, 3> corners;
      for (int c = 0; c < 3; ++c) corners[c] = (glm::dvec3(mesh.positions[t[c]]) - origin) / h_;
      triangles_.push_back(corners);
    }
  }

  /// 4 / F_dt of the flux by the diffusion equation, W/m^2.
  glm::dvec3 bracket(glm::dvec3 p, int side) const {
    const glm::dvec3 phi = glm::max(sample(field_[side], p), 0.0), gamma = sample(drive_[side], p);
    return glm::max((1 + 1 / A_) * phi - 4.0 * gamma / (f_dt_ * A_), 0.0);
  }

  glm::dvec3 refracted_inwards(glm::dvec3 outside, glm::dvec3 normal, double cosine) const {
    return glm::normalize((cosine * normal - outside) / eta_ - refracted_cosine<double>(cosine, eta_) * normal);
  }

  double exit_of(double cosine) const {  // of the table, which is linear between its entries
    const double place = std::sqrt(cosine) * (GATHER_EXITS - 1);
    const int before = std::min(int(place), GATHER_EXITS - 2);
    return glm::mix(double(exits_[before]), double(exits_[before + 1]), place - before);
  }

  static int side_of(glm::dvec3 normal) { return facet_class(normal) & 1; }

  /// What arrives at `from` (h) along -`along`.
  Gathered along(glm::dvec3 from, glm::dvec3 normal, glm::dvec3 along) const {
    glm::dvec3 far_normal(0);
    const double out = end_of(from, along, far_normal);
    const int side = side_of(normal);
    Gathered sum;
    glm::dvec3 left(1), tau(1e3);
    Solid s, first;
    bool inside = false;
    glm::ivec3 cell(glm::floor(from - 1e-3 * normal));
    for (double at = 0; at < out;) {
      int axis = 0;
      double next = 1e30;
      for (int a = 0; a < 3; ++a) {
        if (std::abs(along[a]) <= 1e-9) continue;
        const double t = std::max(0.0, (cell[a] + (along[a] > 0 ? 1 : 0) - from[a]) / along[a]);
        if (t < next) next = t, axis = a;
      }
      if (const Solid here = solid(cell); here.there) s = here;
      if (s.there) {
        if (!inside) first = s;
        inside = true;
        const double end = std::min(out, next), length = end - at;
        for (int c = 0; c < 3; ++c) {
          const double depth = s.sigma_t[c] * length, lost = left[c] * (1 - std::exp(-depth)) * s.albedo[c];
          const glm::dvec3 p = from + (at + length * loss_place<double>(depth)) * along;
          const GatherClosure closure = closure_of(s.albedo[c]);
          const double phi = std::max(0.0, sample(field_[nearer(p, cell, side)], p)[c]), beams = sample(fluence_, p)[c];
          sum.single[c] += lost * beams * sample(unscattered_, from + (at + 0.5 * length) * along)[c];
          sum.all[c] +=
              lost * (closure.diffuse * phi + closure.beams * beams + (closure.beams - 1) * sample(shift_, p)[c]);
          left[c] *= std::exp(-depth);
        }
        const glm::dvec3 p = from + end * along;
        if (std::max({left.x, left.y, left.z}) * std::exp(GATHER_DEEP) < 1) {
          sum.all += left * s.albedo * glm::max(sample(field_[side], p), 0.0);
          break;
        }
        if (end == out) {
          const double cosine = std::max(glm::dot(far_normal, along), 1e-3);
          tau = -glm::log(glm::max(left, glm::dvec3(1e-30)));
          add_near(p, far_normal, s, cosine, tau, true, sum);
          sum.all += left * fresnel_reflectance<double>(cosine, 1 / eta_) * bracket(p, side_of(far_normal));
          break;
        }
      } else if (at > 2) {
        break;
      }
      at = std::max(at, next);
      cell[axis] += along[axis] > 0 ? 1 : -1;
    }
    if (inside) add_near(from, normal, first, std::max(-glm::dot(normal, along), 1e-3), tau, false, sum);
    return sum;
  }

 private:
  struct Solid {
    bool there = false;
    glm::dvec3 sigma_t{0}, albedo{0};  // 1/h
  };
  bool in_grid(glm::ivec3 c) const { return glm::all(glm::lessThan(glm::uvec3(c), glm::uvec3(n_))); }
  std::size_t at(glm::ivec3 c) const { return c.x + std::size_t(n_.x) * (c.y + std::size_t(n_.y) * c.z); }

  Solid solid(glm::ivec3 c) const {
    Solid s;
    if (!in_grid(c) || volume_[at(c)] <= 0) return s;
    s.there = true;
    for (int k = 0; k < 3; ++k) {
      const double kap = kappa_[k * volume_.size() + at(c)] * scale_[k];
      s.sigma_t[k] = h_ / (3 * kap);
      s.albedo[k] = 1 - 3 * kap * absorption_[k * volume_.size() + at(c)] * scale_[k] / (h_ * h_);
    }
    return s;
  }

  /// Trilinear between the cells' centres.
  glm::dvec4 sample4(const std::vector<glm::vec4>& texels, glm::dvec3 p) const {
    const glm::dvec3 low = glm::floor(p - 0.5), share = p - 0.5 - low;
    glm::dvec4 sum(0);
    for (int k = 0; k < 8; ++k) {
      const glm::ivec3 d(k & 1, k >> 1 & 1, k >> 2);
      const glm::ivec3 c = glm::clamp(glm::ivec3(low) + d, glm::ivec3(0), n_ - 1);
      double weight = 1;
      for (int a = 0; a < 3; ++a) weight *= d[a] ? share[a] : 1 - share[a];
      sum += weight * glm::dvec4(texels[at(c)]);
    }
    return sum;
  }
  glm::dvec3 sample(const std::vector<glm::vec4>& texels, glm::dvec3 p) const { return sample4(texels, p); }

  double end_of(glm::dvec3 from, glm::dvec3 along, glm::dvec3& normal) const {
    double first = 1e30;
    for (const auto& t : triangles_) {
      const glm::dvec3 n = glm::cross(t[1] - t[0], t[2] - t[0]);
      const double rate = glm::dot(n, along), s = rate > 0 ? glm::dot(n, t[0] - from) / rate : -1;
      if (s < 0 || s >= first) continue;
      const glm::dvec3 p = from + s * along;
      bool within = true;
      for (int c = 0; c < 3; ++c)
        within = within && glm::dot(n, glm::cross(t[(c + 1) % 3] - t[c], p - t[c])) >= -1e-9 * glm::dot(n, n);
      if (within) first = s, normal = glm::normalize(n);
    }
    return first;
  }

  int nearer(glm::dvec3 p, glm::ivec3 cell, int side) const {
    const GpuCutCell& cut = cuts_[in_grid(cell) ? cut_index_[at(cell)] : 0];
    if (cut.side[0].area <= 0 || cut.side[1].area <= 0) return side;
    double to[2];
    for (int s = 0; s < 2; ++s)
      to[s] = std::abs(glm::dot(glm::normalize(glm::dvec3(cut.side[s].area_vector)),
                                p - glm::dvec3(cell) - glm::dvec3(cut.side[s].centre)));
    return to[1] < to[0];
  }

  GatherClosure closure_of(double albedo) const {  // of the table, which is linear between its entries
    const double place = std::sqrt(std::clamp((1 - albedo) / GATHER_MOST_ABSORBED, 0.0, 1.0)) * (GATHER_CLOSURES - 1);
    const int before = std::min(int(place), GATHER_CLOSURES - 2);
    const glm::dvec2 mixed = glm::mix(glm::dvec2(closures_[before]), glm::dvec2(closures_[before + 1]), place - before);
    return {mixed.x, mixed.y};
  }

  void add_near(glm::dvec3 p, glm::dvec3 normal, const Solid& s, double view, glm::dvec3 tau, bool behind,
                Gathered& sum) const {
    const int side = side_of(normal);
    const glm::dvec4 near = sample4(near_[side], p);
    const auto there = [&](double depth) { return solid(glm::ivec3(glm::floor(p - depth * normal))).there; };
    double bound = BEAM_NEAR_DEPTH;
    if (!there(1.25) || !there(0.75)) {
      const glm::ivec3 cell(glm::floor(p - 1e-3 * normal));
      const GpuFacet& facet = cuts_[in_grid(cell) ? cut_index_[at(cell)] : 0].side[side];
      if (facet.area > 0) bound = std::clamp(double(facet.distance), 0.05, BEAM_NEAR_DEPTH);
    }
    const double mu = std::max<double>(near.a, 0.05), thickness = (s.sigma_t.x + s.sigma_t.y + s.sigma_t.z) / 3,
                 skin = std::min(bound, skin_depth<double>(thickness / mu, BEAM_SKIN_DEPTH));
    for (int c = 0; c < 3; ++c) {
      const NearLight n{float(near[c]),
                        float(mu),
                        float(std::max(skin * s.sigma_t[c], 1e-4)),
                        float(std::max(bound * s.sigma_t[c], 1e-4)),
                        float(s.albedo[c]),
                        float(view),
                        float(tau[c])};
      const double once = behind ? near_single_behind(n) : near_single(n);
      const GatherClosure closure = closure_of(s.albedo[c]);
      sum.single[c] += once * sample(unscattered_, p)[c];
      sum.all[c] += closure.beams * once - closure.diffuse * (behind ? near_surplus_behind(n) : near_surplus(n));
    }
  }

  const double eta_, A_, f_dt_;
  const glm::ivec3 n_;
  const double h_;
  const std::vector<GpuCutCell> cuts_;
  const std::vector<std::uint32_t> cut_index_;
  const std::vector<float> volume_, kappa_, absorption_;
  const glm::dvec3 scale_;
  const std::vector<glm::vec4> fluence_, shift_;
  std::vector<glm::vec2> closures_;
  std::vector<float> exits_;
  std::vector<glm::vec4> unscattered_, near_[2], field_[2], drive_[2];
  std::vector<std::array<glm::dvec3, 3>> triangles_;  // h
};

}  // namespace alabaster
