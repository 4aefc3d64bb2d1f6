#include <gtest/gtest.h>

#include <random>

#include "scene/error.h"
#include "scene/files.h"
#include "scene/load.h"
#include "support/hostile.h"
#include "support/temp_folder.h"

namespace alabaster {
namespace {

using namespace test;

TEST(HostileScenes, AreRefusedInOneLineThatNamesFileAndField) {
  TempFolder folder;
  std::vector<HostileScene> scenes = make_hostile_scenes(folder / ".");
  EXPECT_GE(scenes.size(), 40u);
  for (const HostileScene& scene : scenes) {
    SCOPED_TRACE(scene.name);
    std::string said;
    bool ok = true;
    try {
      for (const std::string& warning : load_scene(scene.path).warnings) said += warning + "\n";
    } catch (const UserError& error) {
      ok = false;
      said = error.what();
      EXPECT_EQ(said.find('\n'), std::string::npos) << said;
      EXPECT_EQ(said.find(scene.path), 0u) << said;
      EXPECT_LT(said.size(), 700u);
    }
    EXPECT_EQ(ok, scene.expect_ok || !scene.refused_by_loader) << said;
    if (!scene.refused_by_loader) continue;
    for (const std::string& word : scene.expected_words)
      EXPECT_NE(said.find(word), std::string::npos) << word << " in: " << said;
  }
}

TEST(HostileScenes, TheGoodOneIsGood) {
  TempFolder folder;
  make_hostile_scenes(folder / ".");
  EXPECT_TRUE(load_scene(folder / "good.glb").warnings.empty());
}

TEST(HostileScenes, RandomDamageNeverDoesMoreThanAnError) {
  TempFolder folder;
  make_hostile_scenes(folder / ".");
  std::string good = read_file(folder / "good.glb");
  std::mt19937 random(1);
  int refused = 0;
  for (int round = 0; round < 300; ++round) {
    std::string bytes = good;
    for (unsigned i = 0; i <= random() % 4; ++i) bytes[random() % (round % 2 ? bytes.size() : 4000)] = char(random());
    write_file(folder / "damaged.glb", bytes);
    try {
      load_scene(folder / "damaged.glb");
    } catch (const UserError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace alabaster
