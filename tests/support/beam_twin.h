// The double-precision twin of lighting/beam_march.comp: the same march in watts, without its whole units.
#pragma once

#include <map>

#include "lighting/directional_source.h"
#include "shared/beam.h"
#include "support/diffusion_device.h"

namespace alabaster {

class BeamTwin {
 public:
  struct Side {  // W/m^2 but for the last
    glm::dvec3 gamma_s{0}, query_gamma{0}, skin{0};
    double skin_cosine = 0;
  };
  std::vector<glm::dvec3> power, seen, leaving;                          // W, of each cell, and of each entry
  glm::dvec3 entered{0}, near{0}, in_cells{0}, absorbed{0}, through{0};  // W

  BeamTwin(gpu::Context& context, Body& body, double index)
      : optics_(index),
        n_(body.domain().frame.cells),
        h_(body.domain().frame.h),
        cuts_(body.cut_cells()),
        cut_index_(gpu::download<std::uint32_t>(context, body.domain().cut_index)),
        volume_(gpu::download<float>(context, body.domain().volume)),
        kappa_(gpu::download<float>(context, body.diffusion().kappa())),
        absorption_(gpu::download<float>(context, body.diffusion().absorption())),
        media_(gpu::download<FacetMedium>(context, body.diffusion().facet_medium())),
        scale_(body.diffusion().kappa_scale()),
        channels_(body.diffusion().channels()) {
    power.assign(cut_index_.size(), glm::dvec3(0));
    seen = power;
    leaving.assign(2 * cuts_.size(), glm::dvec3(0));
  }

  /// Light of `flux` (W/m^2, what enters) from the unit direction `towards`, into side `entry % 2` of cut cell `entry /
  /// 2`.
  Side light(std::uint32_t entry, glm::dvec3 normal, glm::dvec3 towards, glm::dvec3 flux) {
    const GpuCutCell& cut = cuts_[entry / 2];
    const GpuFacet& side = cut.side[entry % 2];
    facet_ = {entry / 2, glm::dvec3(cut.cell) + glm::dvec3(side.centre), normal, 0, 0, 0};
    facet_.near = near_of(side);
    const double cosine = glm::dot(normal, towards), area = side.area * h_ * h_;
    facet_.mu = std::max(refracted_cosine<double>(cosine, optics_.eta), 1e-4);
    const glm::dvec3 sigma_t = solid(cut.cell).sigma_t;
    const double thickness = (sigma_t.x + sigma_t.y + sigma_t.z) / channels_;
    facet_.skin = std::min(facet_.near, skin_depth<double>(thickness / facet_.mu, BEAM_SKIN_DEPTH));
    sums_ = {};
    boundary_ = leaving_here_ = glm::dvec3(0);
    const bool given = glm::any(glm::greaterThan(glm::abs(glm::dvec3(side.centre) - 0.5), glm::dvec3(0.51)));
    const glm::ivec3 cell = given ? glm::ivec3(glm::floor(facet_.origin)) : cut.cell;
    entered += area * flux;
    march(cell, glm::normalize((cosine * normal - towards) / optics_.eta - facet_.mu * normal), area * flux);
    sums_.gamma_s = boundary_ / area;
    sums_.query_gamma = (boundary_ - optics_.A * leaving_here_) / area;
    const double all = sums_.skin.x + sums_.skin.y + sums_.skin.z;
    sums_.skin_cosine = all > 0 ? facet_.mu : 1;
    sums_.skin /= area;
    return sums_;
  }

 private:
  struct Solid {
    bool there = false;
    glm::dvec3 sigma_t{0}, albedo{0};  // 1/h
  };
  struct Facet {
    std::uint32_t index = 0;
    glm::dvec3 origin{0}, normal{0};
    double mu = 0, near = 0, skin = 0;
  };
  struct Way {
    glm::dvec3 from, along;
    glm::ivec3 cell;
    glm::dvec3 next, each;
    double at = 0;
    double end() const { return std::min({next.x, next.y, next.z}); }
    void step() {
      const int a = next.x <= next.y && next.x <= next.z ? 0 : next.y <= next.z ? 1 : 2;
      at = std::max(at, next[a]);
      cell[a] += along[a] > 0 ? 1 : -1;
      next[a] += each[a];
    }
  };
  struct Beam {
    glm::dvec3 start, left, depth{0};
  };
  struct Node {
    glm::ivec3 cell{0};
    bool open = false;
    double depth = 0;
    struct {
      glm::dvec3 watts{0}, behind{0}, behind_depth{0};
    } laid[BEAM_LAYERS];
  };

  bool in_grid(glm::ivec3 c) const { return glm::all(glm::lessThan(glm::uvec3(c), glm::uvec3(n_))); }
  std::size_t at(glm::ivec3 c) const { return c.x + std::size_t(n_.x) * (c.y + std::size_t(n_.y) * c.z); }
  std::uint32_t cut(glm::ivec3 c) const { return in_grid(c) ? cut_index_[at(c)] : 0; }

  Solid solid(glm::ivec3 c) const {
    Solid s;
    if (!in_grid(c) || volume_[at(c)] <= 0) return s;
    s.there = true;
    for (int k = 0; k < channels_; ++k) {
      const double kap = std::max(kappa_[k * volume_.size() + at(c)] * scale_[k], 1e-30);
      const double sigma_a = absorption_[k * volume_.size() + at(c)] * scale_[k] / (h_ * h_);
      s.sigma_t[k] = h_ / (3 * kap);
      s.albedo[k] = std::clamp(1 - 3 * kap * sigma_a, 0.0, 1.0);
    }
    return s;
  }

  static Way way(glm::dvec3 from, glm::dvec3 along, glm::ivec3 cell) {
    Way w{from, along, cell, {}, {}, 0};
    for (int a = 0; a < 3; ++a) {
      const bool moves = std::abs(along[a]) > 1e-9;
      w.each[a] = moves ? 1 / std::abs(along[a]) : 1e30;
      w.next[a] = moves ? std::max(0.0, (cell[a] + (along[a] > 0 ? 1 : 0) - from[a]) / along[a]) : 1e30;
    }
    return w;
  }

  double leaves_at(const Way& w, std::uint32_t index, double end, glm::dvec3& normal) const {
    double first = 1e30;
    for (int s = 0; s < 2 && index != 0; ++s) {
      const GpuFacet& side = cuts_[index].side[s];
      const double size = glm::length(glm::dvec3(side.area_vector));
      if (side.area <= 0 || size <= 0.5 * side.area) continue;
      const glm::dvec3 m = glm::dvec3(side.area_vector) / size;
      const double rate = glm::dot(m, w.along),
                   off = glm::dot(m, w.from - glm::dvec3(w.cell) - glm::dvec3(side.centre));
      if (rate <= 1e-6 || off + rate * end <= 1e-4) continue;
      const double t = std::max(w.at, -off / rate);
      if (t < first) first = t, normal = m;
    }
    return first;
  }

  double near_of(const GpuFacet& side) const {
    const auto cell = [&](double depth) { return glm::ivec3(glm::floor(facet_.origin - depth * facet_.normal)); };
    return solid(cell(1.25)).there && solid(cell(0.75)).there ? BEAM_NEAR_DEPTH
                                                              : std::min(double(side.distance), BEAM_NEAR_DEPTH);
  }

  glm::dvec3 lose(Beam& b, const Solid& s, double length) {
    b.depth += s.sigma_t * length;
    const glm::dvec3 now = glm::min(b.left, b.start * glm::exp(-b.depth)), lost = b.left - now;
    b.left = now;
    absorbed += lost * (1.0 - s.albedo);
    return lost * s.albedo;
  }
  static glm::dvec3 mean_place(const Solid& s, double length) {
    glm::dvec3 place;
    for (int c = 0; c < 3; ++c) place[c] = length * loss_place<double>(s.sigma_t[c] * length);
    return place;
  }

  void drive_boundary(glm::dvec3 watts, glm::dvec3 depth) {
    near += watts;
    for (int c = 0; c < channels_; ++c) {
      const double kap = media_[facet_.index].kappa[c], z = depth[c] * h_;
      const double per_length = std::sqrt(media_[facet_.index].sigma_a[c] / kap);
      const double f = buried_boundary<double>(z, per_length, kap, optics_.A, optics_.f_dt);
      boundary_[c] += watts[c] * f;
      leaving_here_[c] += watts[c] * (buried_cosh<double>(z, per_length) - f);
    }
  }

  void lay_down(glm::ivec3 cell, glm::dvec3 watts, int layer) {
    seen[at(cell)] += watts;
    if (layer == BEAM_SHALLOW) return;
    in_cells += watts;
    power[at(cell)] += watts;
  }
  void close(Node& node) {
    for (int k = 0; k < BEAM_LAYERS && node.open; ++k) lay_down(node.cell, node.laid[k].watts + node.laid[k].behind, k);
    node.open = false;
  }
  void leave(std::uint32_t index, glm::dvec3 normal, glm::dvec3 watts) {
    through += watts;
    const glm::dvec3 size = glm::abs(normal);
    const int axis = size.x >= 0.9999 * size.y && size.x >= 0.9999 * size.z ? 0 : size.y >= 0.9999 * size.z ? 1 : 2;
    std::uint32_t entry = 2 * index + (normal[axis] < 0);
    if (cuts_[index].side[entry % 2].area <= 0) entry ^= 1;
    leaving[entry] += watts;
  }
  static glm::dvec3 share(glm::dvec3 watts, glm::dvec3 part) {
    return watts * glm::clamp(part, glm::dvec3(0), glm::dvec3(1));
  }

  void cross_cell(const Way& w, double end, const Solid& s, bool direct, Beam& beam, Node& node) {
    const glm::dvec3 middle = glm::dvec3(w.cell) + glm::dvec3(cuts_[cut(w.cell)].centre);
    Node here{w.cell, true, glm::dot(facet_.origin - middle, facet_.normal)};
    if (!direct) {
      here.laid[BEAM_DEEP].watts = lose(beam, s, end - w.at);
    } else {
      double apart = node.open ? here.depth - node.depth : 0;
      if (apart < 0.2) apart = 0;
      for (int k = 0; k < BEAM_LAYERS && apart > 0; ++k) {
        const glm::dvec3 forward = share(node.laid[k].behind, (node.laid[k].behind_depth - node.depth) / apart);
        here.laid[k].watts += forward;
        node.laid[k].behind -= forward;
      }
      double from = w.at, to = std::clamp(facet_.skin / facet_.mu, from, end);
      if (to > from) {
        const glm::dvec3 depth = (from + mean_place(s, to - from)) * facet_.mu, lost = lose(beam, s, to - from);
        drive_boundary(lost, depth);
        sums_.skin += lost;
      }
      for (int k : {BEAM_SHALLOW, BEAM_DEEP}) {
        const double stop = k == BEAM_SHALLOW ? std::clamp(facet_.near / facet_.mu, to, end) : end;
        from = to;
        to = std::clamp(here.depth / facet_.mu, from, stop);
        if (to > from) {
          const glm::dvec3 depth = (from + mean_place(s, to - from)) * facet_.mu, lost = lose(beam, s, to - from);
          if (k == BEAM_SHALLOW) drive_boundary(lost, depth);
          const glm::dvec3 back = apart > 0 ? share(lost, (here.depth - depth) / apart) : glm::dvec3(0);
          node.laid[k].watts += back;
          here.laid[k].watts += lost - back;
        }
        here.laid[k].behind_depth = (to + mean_place(s, stop - to)) * facet_.mu;
        here.laid[k].behind = lose(beam, s, stop - to);
        if (k == BEAM_SHALLOW) drive_boundary(here.laid[k].behind, here.laid[k].behind_depth);
        to = stop;
      }
    }
    close(node);
    node = here;
  }

  void spend(const Solid& s, double here, bool direct, Beam& beam, Node& node) {
    const glm::dvec3 scattered = beam.left * s.albedo;
    absorbed += beam.left - scattered;
    const double depth = direct ? here * facet_.mu : 1e30;
    if (depth < facet_.near)
      drive_boundary(scattered, glm::min((here + 1.0 / glm::max(s.sigma_t, glm::dvec3(1e-6))) * facet_.mu,
                                         glm::dvec3(facet_.near)));
    if (depth < facet_.skin)
      sums_.skin += scattered;
    else
      node.laid[depth < facet_.near ? BEAM_SHALLOW : BEAM_DEEP].watts += scattered;
    beam.left = glm::dvec3(0);
  }

  void march(glm::ivec3 cell, glm::dvec3 along, glm::dvec3 watts) {
    Way w = way(facet_.origin, along, cell);
    Beam beam{watts, watts};
    Node node;
    int mirrors = 0;
    bool inside = false;
    std::uint32_t last = facet_.index;
    for (int step = 0; step < 4 * (n_.x + n_.y + n_.z); ++step) {
      const Solid s = solid(w.cell);
      if (!s.there) {
        if (inside || w.at > 2) break;
        w.step();
        continue;
      }
      inside = true;
      glm::dvec3 normal(0);
      double end = w.end();
      const std::uint32_t index = cut(w.cell);
      if (index != 0) last = index;
      const double out = leaves_at(w, index, end, normal);
      const bool leaves = out <= end;
      if (leaves) end = out;
      cross_cell(w, end, s, mirrors == 0, beam, node);
      if (glm::all(glm::lessThanEqual(beam.left * double(BEAM_LEAST_SHARE), watts))) {
        spend(s, end, mirrors == 0, beam, node);
        break;
      }
      if (!leaves) {
        w.step();
        continue;
      }
      const double cosine = glm::dot(normal, w.along);
      glm::dvec3 mirrored = beam.left * fresnel_reflectance<double>(cosine, 1 / optics_.eta);
      if (mirrors == BEAM_MOST_REFLECTIONS) mirrored = glm::dvec3(0);
      leave(index, normal, beam.left - mirrored);
      close(node);
      beam = {mirrored, mirrored};
      if (mirrored == glm::dvec3(0)) break;
      ++mirrors;
      w = way(w.from + end * w.along, glm::normalize(w.along - 2 * cosine * normal), w.cell);
    }
    close(node);
    leave(last, w.along, beam.left);
  }

  const SurfaceOptics optics_;
  const glm::ivec3 n_;
  const double h_;
  const std::vector<GpuCutCell> cuts_;
  const std::vector<std::uint32_t> cut_index_;
  const std::vector<float> volume_, kappa_, absorption_;
  const std::vector<FacetMedium> media_;
  const glm::dvec3 scale_;
  const int channels_;
  Facet facet_;
  Side sums_;
  glm::dvec3 boundary_{0}, leaving_here_{0};  // W, of the facet
};

}  // namespace alabaster
