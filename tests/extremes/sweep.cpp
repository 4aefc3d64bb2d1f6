// The fluence solver at the ends of what a user may ask of it. Whatever the case: every value finite, none below zero
// but for the solver's tolerance, converged by the true residual or a reason why not; where converged, light conserved
// and the solution that of the same system in double precision. ALABASTER_STUDY=1 runs the whole sweep, else a part of
// it.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "alabaster-bench/problems.h"
#include "scene/error.h"
#include "support/diffusion_device.h"
#include "support/diffusion_problems.h"

namespace alabaster {
namespace {

bool study() { return std::getenv("ALABASTER_STUDY") != nullptr; }

struct Case {
  std::string name;
  Mesh mesh;
  MediumField medium;
  int grid = 16;
  double eta = 1.3;
  float gamma_s = 1;         // W/m^2
  bool one_facet = false;    // lit
  bool may_give_up = false;  // beyond what is supported: an honest status will do
  double agreement = 2e-4;   // with the twin, of the largest fluence
};

/// sigma in 1/m; objects are about 1 m across.
MediumField medium_of(double sigma_s, double sigma_a, double g = 0) {
  const MediumPoint point{glm::dvec3(sigma_s * (1 - g)), glm::dvec3(sigma_a)};
  return [point](glm::dvec3) { return point; };
}

MediumField contrasted(const twin::MaterialField& field) {
  return [field](glm::dvec3 p) {
    const twin::Material m = field(p);
    return MediumPoint{glm::dvec3(1 / (3 * m.kappa) - m.sigma_a), glm::dvec3(m.sigma_a)};
  };
}

/// kappa of independent values in blocks, log-normal: `contrast` between two standard deviations below and above.
twin::MaterialField noise(double kappa, double contrast, double block) {
  return [=](glm::dvec3 p) {
    const glm::uvec3 b(glm::ivec3(glm::floor(p / block)) + 1000);
    std::mt19937 engine(b.x + 4001 * (b.y + 4001 * b.z));
    engine.discard(3);
    std::normal_distribution<double> normal;
    return twin::Material{kappa * std::exp(0.25 * std::log(contrast) * normal(engine)), 0};
  };
}

std::string label(const char* format, double a, double b = 0) {
  char text[80];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

class Extremes : public GpuTest {
 protected:
  void expect(const Case& c);

  double worst_twin = 0, worst_imbalance = 0;
  int given_up = 0;
};

/// The device's own system, in double precision.
twin::Solution double_solution(gpu::Context& context, Body& body, glm::ivec3 n) {
  const std::vector<float> stencil = gpu::download<float>(context, body.diffusion().multigrid().finest().stencil),
                           rhs = gpu::download<float>(context, body.diffusion().pcg().rhs());
  twin::Operator a = twin::Operator::seven_point(n);
  twin::Vector& diagonal = a.a[twin::diagonal];
  const twin::Vector reaction = unpack(stencil, a.grid, DIFFUSION_REACTION, DIFFUSION_FINEST_ENTRIES, 0);
  for (std::size_t i = 0; i < diagonal.size(); ++i) diagonal[i] += reaction[i];
  for (int axis = 0; axis < 3; ++axis) {
    glm::ivec3 up(0);
    up[axis] = 1;
    const twin::Vector face = unpack(stencil, a.grid, axis, DIFFUSION_FINEST_ENTRIES, 0);
    for (std::size_t i = 0; i < face.size(); ++i) {
      if (face[i] == 0) continue;
      a.a[twin::low_face[axis]][i] = -face[i];
      diagonal[i] += face[i];
      diagonal[i - a.grid.shift(up)] += face[i];
    }
  }
  const twin::Vector b = unpack(rhs, a.grid, 0, 1, 0);
  twin::Multigrid multigrid(std::move(a), {});
  return twin::solve_pcg(multigrid, b, 1e-11, 300);
}

void Extremes::expect(const Case& c) {
  Body body(context, c.mesh, c.grid, c.medium, 1, c.eta);
  std::vector<glm::vec3> gamma(body.cut_cells().size(), glm::vec3(c.one_facet ? 0 : c.gamma_s));
  if (c.one_facet) gamma[gamma.size() / 2] = glm::vec3(c.gamma_s);
  const Solved solved = body.solve(gamma);
  const FluenceField phi = body.fluence();
  double most = 0, least = 0;
  for (double v : phi.phi) {
    ASSERT_TRUE(std::isfinite(v)) << c.name;
    most = std::max(most, v), least = std::min(least, v);
  }
  for (float v : gpu::download<float>(context, body.diffusion().surface())) ASSERT_TRUE(std::isfinite(v)) << c.name;
  EXPECT_TRUE(solved.status.converged || !solved.status.reason.empty()) << c.name << ": silent";
  EXPECT_TRUE(solved.status.converged || c.may_give_up) << c.name << ": " << solved.status.reason;
  double apart = 0;
  if (solved.status.converged) {
    EXPECT_LE(solved.status.relative_residual[0], 1e-6) << c.name;
    EXPECT_GE(least, -1e-5 * most) << c.name;
    EXPECT_LT(solved.energy.imbalance(), 1e-4) << c.name;
    EXPECT_EQ(most > 0, c.gamma_s > 0) << c.name;
    if (most > 0) {
      const twin::Solution exact = double_solution(context, body, phi.n);
      const double unit = gpu::download<FluenceScale>(context, body.diffusion().scales())[0].unit;
      twin::Lattice grid;
      grid.n = phi.n;
      EXPECT_LT(exact.relative_residual, 1e-10) << c.name << ": the twin itself";
      for (int z = 0; z < phi.n.z; ++z)
        for (int y = 0; y < phi.n.y; ++y)
          for (int x = 0; x < phi.n.x; ++x)
            apart = std::max(apart, std::abs(phi.at({x, y, z}) - unit * exact.x[grid.at({x, y, z})]) / most);
      EXPECT_LT(apart, c.agreement) << c.name;
    }
    worst_twin = std::max(worst_twin, apart);
    worst_imbalance = std::max(worst_imbalance, solved.energy.imbalance());
  } else {
    ++given_up;
  }
  std::printf("%-44s %3d iterations, residual %.1e, imbalance %.1e, least %.1e, twin %.1e%s%s\n", c.name.c_str(),
              solved.status.iterations, solved.status.relative_residual[0], solved.energy.imbalance(),
              most > 0 ? least / most : 0, apart, solved.status.converged ? "" : "; ", solved.status.reason.c_str());
}

TEST_F(Extremes, Media) {
  const std::vector<double> absorption = study() ? std::vector<double>{0, 1e-9, 1e-6, 1e-3, 1, 1e2, 1e4}
                                                 : std::vector<double>{0, 1e-9, 1e4},
                            scattering =
                                study() ? std::vector<double>{1e-3, 1, 1e3, 1e6} : std::vector<double>{1e-3, 1e6},
                            cosine = study() ? std::vector<double>{-0.95, 0, 0.95} : std::vector<double>{0.95};
  for (double sigma_a : absorption)
    for (double sigma_s : scattering)
      for (double g : cosine)
        expect({label("sigma_a %g, sigma_s %g", sigma_a, sigma_s) + label(", g %g", g), icosphere(3, 0.5f),
                medium_of(sigma_s, sigma_a, g)});
  std::printf("worst: twin %.1e, imbalance %.1e\n", worst_twin, worst_imbalance);
}

TEST_F(Extremes, Contrast) {
  const int grid = study() ? 32 : 20;
  const Mesh mesh = icosphere(4, 0.5f);
  const double cell = choose_frame(bounds_of(mesh), grid).h;
  for (double contrast : study() ? std::vector<double>{1e2, 1e4, 1e6} : std::vector<double>{1e6}) {
    expect({label("layers, contrast %g", contrast), mesh, contrasted(sharp_layers(0.02, contrast)), grid});
    expect({label("checker of 4 cells, contrast %g", contrast), mesh,
            contrasted(checker(0.02, contrast, 4 * cell, 0.1)), grid});
    Case fine{label("checker of one cell, contrast %g", contrast), mesh, contrasted(checker(0.02, contrast, cell)),
              grid};
    Case noisy{label("noise at one cell, contrast %g", contrast), mesh, contrasted(noise(0.02, contrast, cell)), grid};
    fine.may_give_up = noisy.may_give_up = contrast > 1e4;
    expect(fine);
    expect(noisy);
    for (const double edge : {1.3, 1.6, 2.0})
      expect({label("checker of %g cells, contrast %g", edge, contrast), mesh,
              contrasted(checker(0.02, contrast, edge * cell)), grid});
    expect({label("noise at 3 cells, contrast %g", contrast), mesh, contrasted(noise(0.02, contrast, 3 * cell)), grid});
  }
  std::printf("worst: twin %.1e, imbalance %.1e; %d gave up\n", worst_twin, worst_imbalance, given_up);
}

TEST_F(Extremes, NoiseAtCellScaleIsSaid) {
  const Mesh mesh = icosphere(4, 0.5f);
  const int grid = 40;
  const double cell = choose_frame(bounds_of(mesh), grid).h;
  const Domain domain = make_domain(context, mesh, choose_frame(bounds_of(mesh), grid));
  const auto told = [&](const MediumField& field) {
    const MediumSamples samples = sample_medium(context, domain, field, 1);
    for (const std::string& warning : samples.warnings) std::printf("%s\n", warning.c_str());
    return std::any_of(samples.warnings.begin(), samples.warnings.end(),
                       [](const std::string& w) { return w.find("noise at the scale") != std::string::npos; });
  };
  EXPECT_TRUE(told(contrasted(checker(0.02, 1e6, cell))));
  EXPECT_TRUE(told(contrasted(checker(0.02, 1e6, 1.3 * cell))));
  EXPECT_TRUE(told(contrasted(noise(0.02, 1e6, cell))));
  for (const double contrast : {1e2, 1e4}) {
    EXPECT_FALSE(told(contrasted(checker(0.02, contrast, cell)))) << contrast;
    EXPECT_FALSE(told(contrasted(noise(0.02, contrast, cell)))) << contrast;
  }
  for (const double edge : {2.0, 3.0, 4.0}) EXPECT_FALSE(told(contrasted(checker(0.02, 1e6, edge * cell)))) << edge;
  for (const double width : {0.1, 0.2, 0.4}) EXPECT_FALSE(told(vein_medium(width, 1e6))) << width;
  for (const double thickness : {0.5, 1.0, 2.0, 5.0})
    EXPECT_FALSE(told(layer_medium(thickness * cell, 1e6))) << thickness;
  EXPECT_FALSE(told(contrasted(sharp_layers(0.02, 1e6))));
  EXPECT_FALSE(told(smooth_medium(1e6)));
  EXPECT_FALSE(told(medium_of(20, 0.5)));
}

TEST_F(Extremes, IndexAndLight) {
  const Mesh mesh = icosphere(3, 0.5f);
  const MediumField medium = medium_of(20, 0.5);
  for (double eta :
       study() ? std::vector<double>{0.4, 0.7, 0.95, 1, 1.05, 1.3, 2, 3} : std::vector<double>{0.5, 1, 3}) {
    Case c{label("eta %g", eta), mesh, medium};
    c.eta = eta;
    expect(c);
  }
  for (float light :
       study() ? std::vector<float>{0, 1e-12f, 1e-6f, 1e6f, 1e12f} : std::vector<float>{0, 1e-12f, 1e12f}) {
    Case c{label("Gamma_s %g", light), mesh, medium};
    c.gamma_s = light;
    expect(c);
    if (light == 0) continue;
    c.name += ", one facet";
    c.one_facet = true;
    expect(c);
  }
  std::printf("worst: twin %.1e, imbalance %.1e\n", worst_twin, worst_imbalance);
}

TEST_F(Extremes, Shapes) {
  const glm::dmat4 turn = rotation({1, 2, 3}, 23);
  Mesh islands;
  for (int i = 0; i < 27; ++i) {
    const glm::dvec3 at(i % 3, i / 3 % 3, i / 9);
    islands = i == 0 ? icosphere(2, 0.11f) : joined(islands, transformed(icosphere(2, 0.11f), translation(0.33 * at)));
  }
  const Mesh half = box({0.4f, 0.9f, 0.9f}, 2);
  const std::pair<const char*, Mesh> shapes[] = {
      {"plate, 1/5 cell", transformed(box({1, 0.008f, 0.9f}, 2), turn)},
      {"needle, 1/3 cell", transformed(cylinder(0.007f, 1, 8), turn)},
      {"box 1:50", box({1, 0.02f, 0.02f}, 2)},
      {"plate 50:50:1", box({1, 1, 0.02f}, 2)},
      {"27 islands", islands},
      {"slit of 1/4 cell", joined(half, transformed(half, translation({0.41, 0, 0})))}};
  for (const auto& [name, mesh] : shapes)
    for (double sigma_a : study() ? std::vector<double>{0, 0.5, 50} : std::vector<double>{0.5})
      for (bool one_facet : {false, true}) {
        Case c{std::string(name) + label(", sigma_a %g", sigma_a) + (one_facet ? ", one facet" : ""), mesh,
               medium_of(30, sigma_a), study() ? 40 : 24};
        c.one_facet = one_facet;
        expect(c);
      }
  std::printf("worst: twin %.1e, imbalance %.1e\n", worst_twin, worst_imbalance);
}

TEST_F(Extremes, Grids) {
  const Mesh mesh = transformed(box({1, 0.6f, 0.8f}, 2), rotation({1, 2, 3}, 23));
  EXPECT_THROW(choose_frame(bounds_of(mesh), 3), UserError);  // says which grids there are
  for (int grid : study() ? std::vector<int>{4, 5, 8, 9, 17, 33, 64, 100, 128, 192} : std::vector<int>{4, 5, 9, 33})
    expect({label("grid %g", grid), mesh, contrasted(log_smooth(0.02, 1e3)), grid});
  std::printf("worst: twin %.1e, imbalance %.1e\n", worst_twin, worst_imbalance);
}

}  // namespace
}  // namespace alabaster
