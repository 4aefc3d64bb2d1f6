// The warning of a grid too coarse for the medium names one that is not.
#include "pipeline/short_ways.h"

#include "support/diffusion_device.h"

namespace alabaster {
namespace {

class ShortWays : public GpuTest {
 protected:
  std::string warning(int grid, const MediumField& field) {
    const Domain domain = make_domain(context, mesh, choose_frame(bounds_of(mesh), grid));
    return short_ways_warning(sample_medium(context, domain, field, 3), domain.frame, grid);
  }
  const Mesh mesh = icosphere(3);
};

TEST_F(ShortWays, NamesTheGridThatResolvesThem) {
  const double kappa = 0.004, length = 0.06;  // a cell of 2 / 20 is longer
  const MediumField field = uniform_medium(kappa, kappa / (length * length));
  const std::string found = warning(20, field);
  ASSERT_NE(found.find("100 % of its surface"), std::string::npos) << found;
  const int grid = std::stoi(found.substr(found.find("--grid") + 7));
  EXPECT_NEAR(grid, 2 / length + 2.5, 1);
  EXPECT_EQ(warning(grid + 1, field), "");
  EXPECT_NE(warning(grid - 4, field), "");
}

TEST_F(ShortWays, SayNothingOfLongOnesNorOfFew) {
  EXPECT_EQ(warning(20, uniform_medium(0.02, 0)), "");
  EXPECT_EQ(warning(20, uniform_medium(0.02, 0.5)), "");
  EXPECT_EQ(
      warning(20,
              [](glm::dvec3 p) {
                return MediumPoint{glm::dvec3(80), glm::dvec3(p.y > 0.95 ? 40 : 0.01)};  // a fortieth of the surface
              }),
      "");
}

}  // namespace
}  // namespace alabaster
