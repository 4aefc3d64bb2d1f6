// Media from .vdb files that the test writes itself, and files that are spoilt.
#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <sys/resource.h>

#include <random>

#include "reference/media.h"
#include "scene/error.h"
#include "scene/files.h"
#include "scene/load.h"
#include "scene/write_gltf.h"
#include "support/hostile.h"
#include "support/temp_folder.h"

namespace alabaster {
namespace {

using nlohmann::json;
using test::Glb;
using test::TempFolder;

const char* const six[] = {"sigma_s.r", "sigma_s.g", "sigma_s.b", "sigma_a.r", "sigma_a.g", "sigma_a.b"};
constexpr double voxel = 0.004;  // m

/// Value of grid `index` at voxel (i, j, k) of 5 x 4 x 3.
float value(int index, int i, int j, int k) { return float(100 * (index + 1) + 10 * i + 3 * j + k); }

/// A grid whose first voxel is (2, -1, 0), its middle at `corner` (m).
openvdb::FloatGrid::Ptr make_grid(const std::string& name, int index, glm::dvec3 corner = {0.08, 0, -0.02}) {
  auto grid = openvdb::FloatGrid::create(7);
  grid->setName(name);
  auto access = grid->getAccessor();
  for (int k = 0; k < 3; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 5; ++i) access.setValue({i + 2, j - 1, k}, value(index, i, j, k));
  auto transform = openvdb::math::Transform::createLinearTransform(voxel);
  transform->postTranslate({corner.x - 2 * voxel, corner.y + voxel, corner.z});
  grid->setTransform(transform);
  return grid;
}

void write_vdb(const std::string& path, const openvdb::GridPtrVec& grids) { openvdb::io::File(path).write(grids); }

openvdb::GridPtrVec all_six() {
  openvdb::initialize();
  openvdb::GridPtrVec grids;
  for (int i = 0; i < 6; ++i) grids.push_back(make_grid(six[i], i));
  return grids;
}

Scene with_medium(const TempFolder& folder, const json& medium) {
  write_gltf(test::good_scene(), folder / "scene.glb");
  Glb glb = Glb::read(folder / "scene.glb");
  glb.root["materials"][test::marble]["extras"]["medium"] = medium;
  write_file(folder / "scene.glb", glb.bytes());
  return load_scene(folder / "scene.glb");
}
const Medium& medium_of(const Scene& scene) { return scene.objects[test::marble].medium; }

glm::dvec3 centre(int i, int j, int k) { return glm::dvec3(0.08, 0, -0.02) + voxel * glm::dvec3(i, j, k); }

TEST(VdbMedium, SixGridsAreReadWhereTheirTransformPutsThem) {
  TempFolder folder;
  write_vdb(folder / "a.vdb", all_six());
  for (const char* filter : {"nearest", "trilinear"}) {
    const Scene scene = with_medium(folder, {{"type", "vdb"}, {"file", "a.vdb"}, {"filter", filter}, {"g", 0.25}});
    const Medium& medium = medium_of(scene);
    EXPECT_EQ(medium.g, 0.25);
    const FlatMedium flat(medium);
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 4; ++j)
        for (int k = 0; k < 3; ++k) {
          const Coefficients c = medium.at(centre(i, j, k));
          for (int channel = 0; channel < 3; ++channel) {
            EXPECT_NEAR(c.sigma_s[channel], value(channel, i, j, k), 1e-3);
            EXPECT_NEAR(c.sigma_a[channel], value(3 + channel, i, j, k), 1e-3);
          }
          EXPECT_NEAR(flat.at(centre(i, j, k)).sigma_t.g, value(1, i, j, k) + value(4, i, j, k), 1e-2);
        }
    const double between = medium.at(centre(1, 2, 1) + glm::dvec3(0.3 * voxel, 0, 0)).sigma_s.r;
    EXPECT_NEAR(between, value(0, 1, 2, 1) + (filter == std::string("nearest") ? 0 : 3), 1e-3);
    EXPECT_NEAR(medium.at(centre(-9, 2, 1)).sigma_s.r, value(0, 0, 2, 1), 1e-3);  // clamped, as .vol is
    EXPECT_NEAR(medium.majorant().b, value(2, 4, 3, 2) + value(5, 4, 3, 2), 1e-3);
    EXPECT_NEAR(medium.feature_size(), voxel * (filter == std::string("nearest") ? 1 : 2), 1e-9);
  }
}

TEST(VdbMedium, DensityMultipliesConstants) {
  openvdb::initialize();
  TempFolder folder;
  write_vdb(folder / "d.vdb", {make_grid("density", 0)});
  json medium = {{"type", "vdb"},        {"file", "d.vdb"}, {"density", "density"},
                 {"sigma_s", {2, 3, 4}}, {"sigma_a", 0.5},  {"scale", 10}};
  const Scene coloured = with_medium(folder, medium);
  const Coefficients c = medium_of(coloured).at(centre(3, 1, 2));
  EXPECT_NEAR(c.sigma_s.b, 40 * value(0, 3, 1, 2), 1e-2);
  EXPECT_NEAR(c.sigma_a.g, 5 * value(0, 3, 1, 2), 1e-2);
  medium["sigma_s"] = 2;
  const Scene grey = with_medium(folder, medium);
  EXPECT_TRUE(medium_of(grey).grey());
  EXPECT_NEAR(medium_of(grey).at(centre(3, 1, 2)).sigma_s.b, 20 * value(0, 3, 1, 2), 1e-2);
  // A box of the scene's own; and the grids go out as .vol and come back.
  medium["bbox_min"] = {0.08, 0, -0.02}, medium["bbox_max"] = {0.12, 0.04, 0.02};
  const Scene boxed = with_medium(folder, medium);
  EXPECT_NEAR(medium_of(boxed).at({0.084, 0.005, -0.02 + 0.04 / 6}).sigma_s.b, 20 * value(0, 0, 0, 0), 1e-2);
  write_gltf(boxed, folder / "again.glb");
  const Scene again = load_scene(folder / "again.glb");
  const glm::dvec3 p(0.0913, 0.0137, 0.0042);
  EXPECT_NEAR(medium_of(again).at(p).sigma_a.r, medium_of(boxed).at(p).sigma_a.r, 1e-6);
}

void expect_error(const TempFolder& folder, const json& change, const char* word) {
  json medium = {{"type", "vdb"}, {"file", "a.vdb"}};
  medium.update(change);
  try {
    with_medium(folder, medium);
    ADD_FAILURE() << word;
  } catch (const UserError& error) {
    const std::string said = error.what();
    EXPECT_NE(said.find(word), std::string::npos) << said;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
    EXPECT_NE(said.find("scene.glb"), std::string::npos) << said;
  }
}

TEST(VdbMedium, IsRefusedWithTheReason) {
  TempFolder folder;
  openvdb::GridPtrVec grids = all_six();
  write_vdb(folder / "a.vdb", grids);
  expect_error(folder, {{"file", "b.vdb"}}, "there is no such file");
  expect_error(folder, {{"file", "."}}, "there is no such file");
  expect_error(folder, {{"density", "smoke"}, {"sigma_s", 1}, {"sigma_a", 1}}, "no grid 'smoke'");
  expect_error(folder, {{"density", "sigma_s.r"}, {"sigma_s", -1}, {"sigma_a", 1}}, "sigma_s");
  expect_error(folder, {{"filter", "cubic"}}, "filter");
  expect_error(folder, {{"scale", 0}}, "scale");
  const auto with = [&](int index, const openvdb::GridBase::Ptr& grid, const char* word) {
    openvdb::GridPtrVec changed = grids;
    changed[index] = grid;
    write_vdb(folder / "c.vdb", changed);
    expect_error(folder, {{"file", "c.vdb"}}, word);
  };
  with(3, make_grid(six[3], 3, {0.09, 0, 0}), "another transform");
  auto vectors = openvdb::Vec3SGrid::create();
  vectors->setName(six[2]);
  with(2, vectors, "no floats");
  auto negative = make_grid(six[1], 1);
  negative->getAccessor().setValue({3, 0, 1}, -1);
  with(1, negative, "negative");
  auto unbounded = make_grid(six[5], 5);
  unbounded->getAccessor().setValue({3, 0, 1}, NAN);
  with(5, unbounded, "not finite");
  auto huge = make_grid(six[0], 0);
  huge->getAccessor().setValue({2000000000, 0, 1}, 1);
  with(0, huge, "resample");
  openvdb::GridPtrVec empty;
  for (const char* name : six) {
    auto grid = openvdb::FloatGrid::create();
    grid->setName(name);
    empty.push_back(grid);
  }
  write_vdb(folder / "c.vdb", empty);
  expect_error(folder, {{"file", "c.vdb"}}, "no active voxels");
}

TEST(VdbMedium, SpoiltFilesAreErrorsOrHarmless) {
  TempFolder folder;
  write_vdb(folder / "good.vdb", all_six());
  const std::string good = read_file(folder / "good.vdb");
  std::mt19937 random(11);
  int refused = 0;
  // OpenVDB believes a size of up to 4 GiB that a file claims; here that is memory that is not to be had.
  const rlimit limit{3ull << 30, RLIM_INFINITY};
  setrlimit(RLIMIT_AS, &limit);
  for (int i = 0; i < 40; ++i) {
    std::string bytes = good;
    if (i < 20)
      bytes.resize(good.size() * i / 20);
    else
      for (int flip = 0; flip < 4; ++flip) bytes[random() % bytes.size()] ^= char(1 << random() % 8);
    write_file(folder / "a.vdb", bytes);
    try {
      with_medium(folder, {{"type", "vdb"}, {"file", "a.vdb"}});
    } catch (const UserError& error) {
      ++refused;
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
  EXPECT_GE(refused, 20);
}

}  // namespace
}  // namespace alabaster
