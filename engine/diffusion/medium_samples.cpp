#include "diffusion/medium_samples.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstdio>
#include <mutex>
#include <span>

#include "diffusion/cell_noise.h"
#include "diffusion/face_kappa.h"
#include "diffusion/medium_layer.h"
#include "shared/optics.h"

namespace alabaster {

MediumField field_of(const Medium& medium) {
  const double similarity = 1 - medium.g;
  if (!medium.heterogeneous()) {
    const MediumPoint constant{similarity * medium.homogeneous.sigma_s, medium.homogeneous.sigma_a};
    return [constant](glm::dvec3) { return constant; };
  }
  const auto at = [medium, similarity](glm::dvec3 world) {
    const Coefficients c = medium.at(world);
    return MediumPoint{similarity * c.sigma_s, c.sigma_a};
  };
  return {at, medium.feature_size()};
}

int samples_an_axis(double feature, double h) {
  return static_cast<int>(std::clamp(std::ceil(2 * h / feature - 1e-6), 1.0, double(most_samples_an_axis)));
}

namespace {

constexpr double least_thickness = 1.6, least_layer = 3;  // h: below both, plate and diffusion length, the grid shows

/// kappa of columns in parallel.
struct Parallel {
  glm::dvec3 sum{0};
  double weights = 0;
  void add(double weight, double length, glm::dvec3 resistance) {
    sum += weight * length / resistance;
    weights += weight;
  }
  glm::dvec3 kappa() const { return sum / weights; }
};

class Averaging {
 public:
  Averaging(gpu::Context& context, const Domain& domain, const MediumField& field)
      : frame_(domain.frame),
        n_(frame_.cells),
        h_(frame_.h),
        most_kappa_(100 * h_ * std::max({n_.x, n_.y, n_.z})),
        field_(field),
        summary_(domain.summary),
        pattern_(samples_an_axis(field.feature, h_)),
        volume_(gpu::download<float>(context, domain.volume)),
        cut_index_(gpu::download<std::uint32_t>(context, domain.cut_index)),
        cut_cells_(gpu::download<GpuCutCell>(context, domain.cut_cells)) {}

  MediumSamples run(int channels) {
    out_.channels = channels;
    out_.kappa.assign(volume_.size() * channels * DIFFUSION_FINEST_ENTRIES, 0.f);
    out_.absorption.assign(volume_.size() * channels, 0.f);
    out_.cell_kappa.assign(volume_.size() * channels, 0.f);
    out_.facets.resize(cut_cells_.size());
    out_.kappa_scale = glm::dvec3(0);
    // Faces need the layer below: the first of a run of layers is sampled twice.
    tbb::parallel_for(tbb::blocked_range<int>(0, n_.z, 8), [&](const tbb::blocked_range<int>& range) {
      Layer below = empty_layer(), own = empty_layer();
      glm::dvec3 largest(0);
      if (range.begin() > 0) sample_layer(range.begin() - 1, own, nullptr);
      for (int z = range.begin(); z < range.end(); ++z) {
        std::swap(below, own);
        sample_layer(z, own, &largest);
        join_faces(z, own, below);
      }
      const std::lock_guard lock(guard_);
      out_.kappa_scale = glm::max(out_.kappa_scale, largest);
    });
    judge();
    judge_noise();
    for (int c = 0; c < channels; ++c) scale(c, static_cast<float>(1 / out_.kappa_scale[c]));
    return std::move(out_);
  }

 private:
  std::size_t at(glm::ivec3 c) const { return c.x + std::size_t(n_.x) * (c.y + std::size_t(n_.y) * c.z); }
  Layer empty_layer() const {
    const std::size_t cells = std::size_t(n_.x) * n_.y;
    return {std::vector<glm::vec3>(cells * pattern_.count()), std::vector<std::uint64_t>(cells, 0),
            std::vector<Texture>(cells)};
  }
  MediumPoint medium_at(glm::dvec3 grid_position) const {
    return field_(glm::dvec3(frame_.origin) + h_ * grid_position);
  }
  glm::dvec3 resistivity(const MediumPoint& m) const {
    return glm::max(3.0 * (m.sigma_s_reduced + m.sigma_a), glm::dvec3(1 / most_kappa_));
  }

  /// Fills `layer`; absorption and facets too where `largest` is there, which takes the largest kappa, m.
  void sample_layer(int z, Layer& layer, glm::dvec3* largest) {
    for (int y = 0; y < n_.y; ++y)
      for (int x = 0; x < n_.x; ++x) {
        const std::size_t i = at({x, y, z}), in_layer = x + std::size_t(n_.x) * y;
        layer.solid[in_layer] = 0;
        if (volume_[i] <= 0) continue;
        const GpuCutCell& cut = cut_cells_[cut_index_[i]];
        const glm::dvec3 corner(x, y, z);
        const CellMean mean = sample_cell(corner, cut, layer, in_layer);
        if (!largest) continue;
        for (int c = 0; c < out_.channels; ++c) {
          out_.absorption[c * volume_.size() + i] = static_cast<float>(mean.sigma_a[c] * h_ * h_);
          out_.cell_kappa[c * volume_.size() + i] = static_cast<float>(1 / mean.resistivity[c]);
        }
        for (int s = 0; s < pattern_.count(); ++s)
          if (layer.solid[in_layer] >> s & 1)
            *largest = glm::max(*largest, 1.0 / glm::dvec3(layer.resistivity[in_layer * pattern_.count() + s]));
        if (cut_index_[i] == 0) continue;
        FacetMedium& facet = out_.facets[cut_index_[i]];
        facet = facet_medium(corner, cut);
        for (int c = 0; c < out_.channels; ++c)
          if (mean.sigma_a[c] * least_layer * h_ * least_layer * h_ > facet.kappa[c]) {
            ++dark_cells_;
            break;
          }
        *largest = glm::max(*largest, glm::dvec3(facet.kappa));
      }
  }

  /// Where one unknown stands for both sheets of a plate it cannot follow the bend of phi between them.
  void judge() {
    const double thickness = 2 * summary_.volume / summary_.area / h_,  // of a plate
        share = double(dark_cells_) / double(std::max<std::size_t>(1, cut_cells_.size() - 1));
    if (thickness > least_thickness || share < 0.02) return;
    out_.warnings.push_back("it is about a cell thick and absorbs within " + std::to_string(int(least_layer)) +
                            " cells (" + std::to_string(int(std::lround(100 * share))) +
                            " % of its surface): stripes of the grid show; use a finer --grid");
  }

  void judge_noise() {
    const std::span<const float> all(out_.cell_kappa);
    double noise = 1;
    for (int c = 0; c < out_.channels; ++c)
      noise = std::max(noise, cell_noise(n_, all.subspan(c * volume_.size(), volume_.size())));
    if (noise <= 1.5 * most_cell_noise) return;
    char text[240];
    std::snprintf(text, sizeof text,
                  "its medium is noise at the scale of the grid's cells, of contrast %.0e (to 1e4 is supported): the "
                  "grid decides where light gets through; use a smoother medium or a finer --grid",
                  noise);
    out_.warnings.push_back(text);
  }

  /// Behind both sheets where the surface bends back, else behind the one.
  static bool in_solid(const GpuCutCell& cut, glm::dvec3 p) {
    const auto behind = [&](const GpuFacet& f) {
      return f.area <= 0 || glm::dot(p - glm::dvec3(f.centre), glm::dvec3(f.area_vector)) <= 0;
    };
    const bool bent = glm::length(cut.facet.area_vector) <= 0.5f * cut.facet.area;
    return bent ? behind(cut.side[0]) && behind(cut.side[1]) : behind(cut.facet);
  }

  struct CellMean {  // over the solid part, 1/m
    glm::dvec3 sigma_a, resistivity;
  };

  /// The points are moved so that their mean is the centroid: what varies linearly has no error.
  CellMean sample_cell(glm::dvec3 corner, const GpuCutCell& cut, Layer& layer, std::size_t in_layer) const {
    std::uint64_t solid = 0;
    glm::dvec3 mean(0), sigma_a(0), resistivities(0);
    for (int s = 0; s < pattern_.count() && pattern_.m() > 1; ++s)
      if (in_solid(cut, pattern_[s])) solid |= std::uint64_t(1) << s, mean += pattern_[s];
    const int count = std::popcount(solid);
    const glm::dvec3 centre(cut.centre), shift = count > 0 ? centre - mean / double(count) : glm::dvec3(0);
    layer.texture[in_layer] = {};
    glm::vec3* values = &layer.resistivity[in_layer * pattern_.count()];
    if (count == 0) {  // one sample, or a sliver between the points
      const MediumPoint m = medium_at(corner + centre);
      std::fill(values, values + pattern_.count(), glm::vec3(resistivity(m)));
      layer.solid[in_layer] = pattern_.count() == 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << pattern_.count()) - 1;
      return {m.sigma_a, resistivity(m)};
    }
    layer.solid[in_layer] = solid;
    for (int s = 0; s < pattern_.count(); ++s) {
      if (!(solid >> s & 1)) continue;
      const MediumPoint m = medium_at(corner + pattern_[s] + shift);
      values[s] = glm::vec3(resistivity(m));
      sigma_a += m.sigma_a;
      resistivities += resistivity(m);
    }
    layer.texture[in_layer] = texture_of(pattern_, values, solid);
    return {sigma_a / double(count), resistivities / double(count)};
  }

  /// Of the layer between the surface and the unknown: kappa in series down to it and in parallel along the surface;
  /// exp(-sigma_a / sigma_s') where the light that enters has its first collision.
  FacetMedium facet_medium(glm::dvec3 corner, const GpuCutCell& cut) const {
    if (pattern_.m() == 1) {
      const MediumPoint m = medium_at(corner + glm::dvec3(cut.centre));
      return facet_point(m);
    }
    const int m = pattern_.m();
    Parallel conduction;
    glm::dvec3 reduced(0), absorbed(0);
    for (const GpuFacet& side : cut.side) {
      const double length = glm::length(glm::dvec3(side.area_vector));
      if (side.area <= 0 || length <= 0) continue;
      const glm::dvec3 normal = glm::dvec3(side.area_vector) / length,
                       aside = std::abs(normal.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0),
                       u = glm::normalize(glm::cross(normal, aside)), v = glm::cross(normal, u);
      const double depth = std::max(double(side.distance), least_distance),
                   edge = std::min(1.0, std::sqrt(double(side.area)));
      for (int column = 0; column < m * m; ++column) {
        const int a = column % m, b = column / m;
        const glm::dvec3 top =
            corner + glm::dvec3(side.centre) + edge * ((a + 0.5) / m - 0.5) * u + edge * ((b + 0.5) / m - 0.5) * v;
        glm::dvec3 resistance(0), arrives(1), first(0), share(0), sigma_a(0);
        for (int s = 0; s < m; ++s) {
          const MediumPoint here = medium_at(top - depth * pattern_.along(s, a, b) * normal);
          const glm::dvec3 optical = (here.sigma_s_reduced + here.sigma_a) * (depth * h_ / m);
          const glm::dvec3 passes = glm::exp(-optical), collides = arrives * glm::max(1.0 - passes, 1e-12);
          first += collides * reduced_at(here);
          share += collides;
          arrives *= passes;
          resistance += resistivity(here) / double(m);
          sigma_a += here.sigma_a / double(m);
        }
        conduction.add(side.area, 1, resistance);
        reduced += double(side.area) * first / share;
        absorbed += double(side.area) * sigma_a;
      }
    }
    if (conduction.weights <= 0) {
      const MediumPoint point = medium_at(corner + glm::dvec3(cut.centre));
      return facet_point(point);
    }
    return {glm::vec3(conduction.kappa()), glm::vec3(reduced / conduction.weights),
            glm::vec3(absorbed / conduction.weights)};
  }

  FacetMedium facet_point(const MediumPoint& m) const {
    return {glm::vec3(1.0 / resistivity(m)), glm::vec3(reduced_at(m)), glm::vec3(m.sigma_a)};
  }

  static glm::dvec3 reduced_at(const MediumPoint& m) {
    glm::dvec3 reduced;
    for (int c = 0; c < 3; ++c) reduced[c] = reduced_intensity(m.sigma_a[c], m.sigma_s_reduced[c]);
    return reduced;
  }

  FaceSide side(const Layer& layer, glm::ivec3 cell, int axis) const {
    const std::size_t in_layer = cell.x + std::size_t(n_.x) * cell.y;
    return {&layer.resistivity[in_layer * pattern_.count()], layer.solid[in_layer], &layer.texture[in_layer],
            double(cut_cells_[cut_index_[at(cell)]].centre[axis])};
  }

  void join_faces(int z, const Layer& own, const Layer& below) {
    for (int y = 0; y < n_.y; ++y)
      for (int x = 0; x < n_.x; ++x) {
        const glm::ivec3 cell(x, y, z);
        if (own.solid[x + std::size_t(n_.x) * y] == 0) continue;
        for (int axis = 0; axis < 3; ++axis) {
          glm::ivec3 lower = cell;
          --lower[axis];
          if (lower[axis] < 0) continue;
          const Layer& other = axis == 2 ? below : own;
          if (other.solid[lower.x + std::size_t(n_.x) * lower.y] == 0) continue;
          const glm::dvec3 kappa = face_kappa(pattern_, side(other, lower, axis), side(own, cell, axis), axis);
          for (int c = 0; c < out_.channels; ++c) out_.kappa[packed(cell, axis, c)] = static_cast<float>(kappa[c]);
        }
      }
  }

  std::size_t packed(glm::ivec3 cell, int entry, int channel) const {
    const std::size_t row = cell.y + std::size_t(n_.y) * (cell.z + std::size_t(n_.z) * channel);
    return cell.x + std::size_t(n_.x) * (entry + DIFFUSION_FINEST_ENTRIES * row);
  }

  void scale(int channel, float factor) {
    const auto scale_part = [&](std::vector<float>& values) {
      const std::size_t part = values.size() / out_.channels;
      tbb::parallel_for(channel * part, (channel + 1) * part, [&](std::size_t i) { values[i] *= factor; });
    };
    scale_part(out_.kappa);
    scale_part(out_.absorption);
    scale_part(out_.cell_kappa);
  }

  const GridFrame frame_;
  const glm::ivec3 n_;
  const double h_, most_kappa_;  // m
  const MediumField& field_;
  const DomainSummary summary_;
  const Pattern pattern_;
  const std::vector<float> volume_;
  const std::vector<std::uint32_t> cut_index_;
  const std::vector<GpuCutCell> cut_cells_;
  MediumSamples out_;
  std::mutex guard_;
  std::atomic<std::size_t> dark_cells_ = 0;  // cut cells with a diffusion length below least_layer
};

}  // namespace

MediumSamples sample_medium(gpu::Context& context, const Domain& domain, const MediumField& field, int channels) {
  return Averaging(context, domain, field).run(channels);
}

}  // namespace alabaster
