// The files we write, under the Khronos glTF validator (npm's gltf-validator); skipped where npm or its registry is not
// to be had.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "scene/demo_scenes.h"
#include "scene/files.h"
#include "scene/procedural.h"
#include "scene/write_gltf.h"
#include "support/temp_folder.h"

namespace alabaster {
namespace {

using Kind = PunctualLight::Kind;

bool done(const std::string& command) { return std::system((command + " >/dev/null 2>&1").c_str()) == 0; }

TEST(GltfValidator, FindsNoErrorInWhatWeWrite) {
  if (!done("node --version") || !done("npm --version"))
    GTEST_SKIP() << "npm is not installed: files are not validated";
  const std::string modules = std::string(ALABASTER_BIN) + "/../gltf-validator";
  if (!std::filesystem::exists(modules + "/node_modules/gltf-validator") &&
      !done("mkdir -p '" + modules + "' && timeout 60 npm install --prefix '" + modules +
            "' --no-audit --no-fund gltf-validator@2.0.0-dev.3.10"))
    GTEST_SKIP() << "npm cannot install gltf-validator: files are not validated";

  test::TempFolder folder;
  for (const char* name : {"sphere-marble", "torus-wax", "box-potato", "plate-leaf", "sphere-furnace"})
    write_gltf(demo_scene(name, ""), folder / (std::string(name) + ".glb"));
  Scene scene = demo_scene("torus-wax", "");
  scene.lights = {{"point", Kind::point, {1, 2, 3}, {0.5f, 0.5f, 0.5f}, {0, 0, -1}, 0, 0.7, 0.01},
                  {"spot", Kind::spot, {9, 2, 3}, {-0.5f, 0.5f, 0.5f}, {0.6f, -0.8f, 0}, 0.1, 0.3, 0.02},
                  {"sun", Kind::directional, {1, 1, 1}, {0, 0, 0}, {0, -1, 0}, 0, 0.7, 0.00465}};
  scene.objects[0].medium.solid = std::make_shared<ProceduralSolid>(usual_solid(solid_wax));
  write_gltf(scene, folder / "lights.glb");
  std::ofstream(folder / "check.js") << R"(
    const fs = require('fs'), validator = require(process.argv[2]);
    (async () => {
      let errors = 0, warnings = 0;
      for (const name of fs.readdirSync(process.argv[3]).filter(n => n.endsWith('.glb'))) {
        const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(process.argv[3] + '/' + name)));
        errors += report.issues.numErrors, warnings += report.issues.numWarnings;
        for (const m of report.issues.messages) if (m.severity < 2) console.log(name, m.code, m.message, m.pointer);
      }
      console.log(errors, 'errors', warnings, 'warnings');
      process.exit(errors ? 1 : 0);
    })();
  )";
  const std::string command = "node '" + (folder / "check.js") + "' '" + std::filesystem::absolute(modules).string() +
                              "/node_modules/gltf-validator' '" + (folder / "") + "'";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

}  // namespace
}  // namespace alabaster
