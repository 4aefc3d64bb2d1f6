// Veins finer than a cell, wherever they lie against the grid: neither lost nor doubled.
#include <algorithm>
#include <numbers>
#include <vector>

#include "support/diffusion_device.h"

namespace alabaster {
namespace {

class MediumVeins : public GpuTest {};

struct Sheet {  // of the slab, from the top down
  double thickness, kappa, sigma_a;
};

/// phi and the flux J = -kappa phi' along the depth of a layered slab lit from the top by q: both are continuous.
class LayeredSlab {
 public:
  LayeredSlab(std::vector<Sheet> sheets, double A, double q) : sheets_(std::move(sheets)) {
    // phi + 2 A J = q at the top; phi - 2 A J = 0 at the bottom, which is linear in the phi at the top.
    const auto below = [&](double phi) {
      const State s = at(INFINITY, {phi, (q - phi) / (2 * A)});
      return s.phi - 2 * A * s.flux;
    };
    const double zero = below(0), one = below(1);
    top_ = {-zero / (one - zero), 0};
    top_.flux = (q - top_.phi) / (2 * A);
  }
  double phi(double depth) const { return at(depth, top_).phi; }
  double flux(double depth) const { return at(depth, top_).flux; }

 private:
  struct State {
    double phi, flux;
  };
  State at(double depth, State s) const {
    for (const Sheet& sheet : sheets_) {
      const double x = std::min(depth, sheet.thickness);
      if (sheet.sigma_a > 0) {
        const double l = std::sqrt(sheet.kappa / sheet.sigma_a), c = std::cosh(x / l), sh = std::sinh(x / l);
        s = {s.phi * c - s.flux * l / sheet.kappa * sh, s.flux * c - s.phi * sheet.kappa / l * sh};
      } else {
        s.phi -= s.flux * x / sheet.kappa;
      }
      if (depth <= sheet.thickness) break;
      depth -= sheet.thickness;
    }
    return s;
  }
  std::vector<Sheet> sheets_;
  State top_{0, 0};
};

/// Box of 0.9 x 0.4 x 0.9 m with a sheet of another medium across `axis`; its sides get the light that makes no flux.
struct VeinedBox {
  static constexpr double kappa = 0.01, height = 0.4;
  double vein_kappa = kappa, vein_sigma_a = 0;  // m, 1/m
  int axis = 1;

  MediumField field(double middle, double thickness, double feature) const {
    const auto at = [=, *this](glm::dvec3 p) {
      const bool vein = std::abs(p[axis] - middle) < 0.5 * thickness;
      const double k = vein ? vein_kappa : kappa, sigma_a = vein ? vein_sigma_a : 0;
      return MediumPoint{glm::dvec3(1 / (3 * k) - sigma_a), glm::dvec3(sigma_a)};
    };
    return {at, feature};
  }
};

constexpr int grid = 18, offsets = 5;
const double h = choose_frame({glm::vec3(-0.45f), glm::vec3(0.45f)}, grid).h;
constexpr double thickness_in_cells = 0.3;

struct Spread {
  double low = INFINITY, high = -INFINITY, sum = 0;
  int count = 0;
  void add(double v) { low = std::min(low, v), high = std::max(high, v), sum += v, ++count; }
  double mean() const { return sum / count; }
};

/// Over offsets of the sheet against the grid: fluence of the dark side's middle by the layered slab's.
Spread dark_side(gpu::Context& context, const VeinedBox& box_, bool averaged) {
  Spread spread;
  const Mesh mesh = box({0.9f, float(VeinedBox::height), 0.9f}, 16);
  const double t = thickness_in_cells * h;
  for (int k = 0; k < offsets; ++k) {
    const double middle = 0.02 + h * k / offsets;
    Body body(context, mesh, grid, box_.field(middle, t, averaged ? t : INFINITY), 1);
    const double A = body.diffusion().A(), above = 0.5 * VeinedBox::height - middle - 0.5 * t;
    const LayeredSlab slab({{above, VeinedBox::kappa, 0},
                            {t, box_.vein_kappa, box_.vein_sigma_a},
                            {VeinedBox::height - above - t, VeinedBox::kappa, 0}},
                           A, dsbc_source(1.0, body.f_dt()));
    std::vector<glm::vec3> gamma(body.cut_cells().size());
    for (std::size_t i = 1; i < gamma.size(); ++i) {
      const GpuFacet& facet = body.cut_cells()[i].facet;
      const double depth = 0.5 * VeinedBox::height - body.facet_centre(i).y, up = facet.area_vector.y / facet.area;
      const double q = slab.phi(depth) + 2 * A * slab.flux(depth) * up;  // d_n phi = -J n.y / kappa, J downwards
      gamma[i] = glm::vec3(static_cast<float>(0.25 * body.f_dt() * std::max(0.0, q)));
    }
    const Solved solved = body.solve(gamma);
    EXPECT_TRUE(solved.status.converged) << solved.status.reason;
    EXPECT_LT(solved.energy.imbalance(), 1e-4);
    spread.add(body.surface_at({0.003, -0.5 * VeinedBox::height, 0.004}) / slab.phi(VeinedBox::height));
  }
  return spread;
}

void expect_kept(gpu::Context& context, const char* what, const VeinedBox& veined, double within) {
  const Spread averaged = dark_side(context, veined, true), once = dark_side(context, veined, false);
  std::printf("%s: mean %.4f, %.4f to %.4f; one sample a cell %.4f to %.4f\n", what, averaged.mean(), averaged.low,
              averaged.high, once.low, once.high);
  EXPECT_GT(averaged.low, 1 - within) << what;
  EXPECT_LT(averaged.high, 1 + within) << what;
  EXPECT_GT(once.high - once.low, 4 * within) << what << ": the test must be able to fail";
}

TEST_F(MediumVeins, AnAbsorbingSheetTakesItsShare) {
  VeinedBox veined;
  veined.vein_sigma_a = 8;  // 0.4 diffusion lengths thick
  expect_kept(context, "absorbing sheet", veined, 0.07);
}

TEST_F(MediumVeins, ASheetOfLowKappaHoldsTheLightBack) {
  VeinedBox veined;
  veined.vein_kappa = VeinedBox::kappa / 100;
  expect_kept(context, "sheet of low kappa", veined, 0.1);
}

// phi = c + b y solves the equation whatever kappa(x) is: a sheet of high kappa along the flux carries its part of it.
TEST_F(MediumVeins, ASheetOfHighKappaCarriesItsFlux) {
  VeinedBox veined;
  veined.axis = 0;
  veined.vein_kappa = 30 * VeinedBox::kappa;
  const double t = thickness_in_cells * h;
  Spread kept[2];
  for (int k = 0; k < offsets; ++k)
    for (bool averaged : {false, true}) {
      const double middle = 0.01 + h * k / offsets;
      Body body(context, box({0.9f, 0.4f, 0.9f}, 16), grid, veined.field(middle, t, averaged ? t : INFINITY), 1);
      const GridFrame& frame = body.domain().frame;
      std::vector<glm::vec3> gamma(body.cut_cells().size());
      double flux = 0;
      for (std::size_t i = 1; i < gamma.size(); ++i) {
        const GpuCutCell& cut = body.cut_cells()[i];
        const double low = frame.origin.x + h * cut.cell.x, high = low + h;
        const double share = std::max(0.0, std::min(high, middle + 0.5 * t) - std::max(low, middle - 0.5 * t)) / h;
        const double kappa = VeinedBox::kappa + share * (veined.vein_kappa - VeinedBox::kappa);
        const double phi = 1 + body.facet_centre(i).y;
        const double q = phi + 2 * body.diffusion().A() * kappa * cut.facet.area_vector.y / cut.facet.area;
        gamma[i] = glm::vec3(static_cast<float>(0.25 * body.f_dt() * q));
        if (cut.facet.area_vector.y > 0.5 * cut.facet.area) flux += kappa * cut.facet.area_vector.y * h * h;
      }
      const Solved solved = body.solve(gamma);
      EXPECT_TRUE(solved.status.converged) << solved.status.reason;
      // What goes in at the top by the solution: sum of B (q - phi) over its facets.
      const FluenceField phi = body.fluence();
      const std::vector<glm::vec4> B = gpu::download<glm::vec4>(context, body.diffusion().facet_conductances());
      double in = 0;
      for (std::size_t i = 1; i < gamma.size(); ++i) {
        const GpuCutCell& cut = body.cut_cells()[i];
        if (cut.facet.area_vector.y <= 0.5 * cut.facet.area) continue;
        in += double(B[i].x) * (dsbc_source(double(gamma[i].x), body.f_dt()) - phi.at(cut.cell));
      }
      const double scale = body.diffusion().kappa_scale()[0] * h;  // of the matrix, theory in twin_problem.h
      kept[averaged].add(in * scale / flux);
    }
  std::printf("sheet of high kappa: mean %.4f, %.4f to %.4f; one sample a cell %.4f to %.4f\n", kept[1].mean(),
              kept[1].low, kept[1].high, kept[0].low, kept[0].high);
  EXPECT_GT(kept[1].low, 0.93);
  EXPECT_LT(kept[1].high, 1.07);
  EXPECT_GT(kept[0].high - kept[0].low, 0.2);
}

// A sheet through a ball, tilted: integral of sigma_a dV in closed form, pi t (R^2 - d^2 - t^2 / 12).
TEST_F(MediumVeins, AbsorptionIsKeptByVolume) {
  const double R = 0.5, t = 0.02;
  const Domain domain = make_domain(context, icosphere(6, float(R)), choose_frame({glm::vec3(-R), glm::vec3(R)}, 24));
  const std::vector<float> volume = gpu::download<float>(context, domain.volume);
  Spread kept, once;
  for (int k = 0; k < 12; ++k) {
    const glm::dvec3 normal = k < 4 ? glm::dvec3(0, 1, 0) : glm::normalize(glm::dvec3(1, 0.2 * k - 1.4, 0.3));
    const double d = 0.1 + 0.013 * k;
    const auto at = [=](glm::dvec3 p) {
      const double sigma_a = std::abs(glm::dot(p, normal) - d) < 0.5 * t ? 3 : 0;
      return MediumPoint{glm::dvec3(100), glm::dvec3(sigma_a)};
    };
    const double exact = 3 * std::numbers::pi * t * (R * R - d * d - t * t / 12);
    for (double feature : {t, double(INFINITY)}) {
      const MediumSamples samples = sample_medium(context, domain, {at, feature}, 1);
      double sum = 0;
      for (std::size_t i = 0; i < volume.size(); ++i) sum += double(samples.absorption[i]) * volume[i];
      (feature < 1 ? kept : once).add(sum * samples.kappa_scale[0] * domain.frame.h / exact);
    }
  }
  std::printf("absorption by volume: mean %.4f, %.4f to %.4f; one sample a cell %.4f to %.4f\n", kept.mean(), kept.low,
              kept.high, once.low, once.high);
  EXPECT_GT(kept.low, 0.97);
  EXPECT_LT(kept.high, 1.03);
}

}  // namespace
}  // namespace alabaster
