// Cut cells of the Stanford bunny (75,408 triangles, from Debian's libcgal-demo): volume, area and closure at every
// grid.
#include <cstdio>
#include <filesystem>

#include "domain/domain.h"
#include "scene/off.h"
#include "scene/shapes.h"
#include "support/device.h"

namespace alabaster {
namespace {

class DomainBunny : public GpuTest {};

TEST_F(DomainBunny, VolumeAndAreaOnEveryGrid) {
  const std::string path = std::string(ALABASTER_MESHES) + "/bunny00.off";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there; third_party/fetch-meshes brings it";
  const Mesh mesh = read_off(path);
  const double exact_volume = signed_volume(mesh), exact_area = area(mesh);
  const DomainMaker maker(context);
  for (int grid : {16, 32, 64, 128}) {
    const DomainSummary s = maker.make(mesh, choose_frame(bounds_of(mesh), grid)).summary;
    std::printf("grid %3d: %u cut cells, volume off by %.1e, area by %.1e, sum of area vectors %.1e of the area\n",
                grid, s.cut_cells, s.volume / exact_volume - 1, s.area / exact_area - 1,
                glm::length(s.area_vector) / s.area);
    EXPECT_NEAR(s.volume / exact_volume, 1, 1e-5) << grid;  // the geometry is exact on any grid, up to rounding
    EXPECT_NEAR(s.area / exact_area, 1, 1e-5) << grid;
    EXPECT_LE(glm::length(s.area_vector), 1e-5 * s.area) << grid;
  }
}

}  // namespace
}  // namespace alabaster
