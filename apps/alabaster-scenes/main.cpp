// alabaster-scenes: makes the scenes of the demo and of the studies.
#include <filesystem>
#include <iostream>

#include "run_app.h"
#include "scene/demo_scenes.h"
#include "scene/error.h"
#include "scene/write_gltf.h"

int main(int argc, char** argv) {
  CLI::App app("Makes the demo and study scenes as .glb, with their .vol grids beside them.", "alabaster-scenes");
  std::string folder, meshes = "build/meshes";
  std::vector<std::string> names = alabaster::demo_scene_names();
  std::string known;
  for (const std::string& name : names) known += "\n  " + name;
  app.add_option("OUTDIR", folder, "folder to write to; made if it is not there")->required();
  app.add_option("--names", names, "scenes to make, with commas between them (default: all)")->delimiter(',');
  app.add_option("--meshes", meshes, "folder of the OFF meshes (default: build/meshes)");
  app.footer("Scenes:" + known +
             "\n  MESH-Nmfp-ALBEDO-ETA, for example bunny-50mfp-0.99-1.3"
             "\n  MESH-MATERIAL-Nmfp-ETA, for example dragon-marble-50mfp-1.3; homogeneous, marble or checker; with "
             "-front, -back or -punctual at the end to choose the light");
  app.callback([&] {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw alabaster::UserError(folder + ": the folder cannot be made; give one that can be written");
    for (const std::string& name : names) {
      alabaster::Scene scene = alabaster::demo_scene(name, meshes);
      for (const std::string& warning : scene.warnings) std::cerr << name << ": " << warning << "\n";
      alabaster::write_gltf(scene, (std::filesystem::path(folder) / (name + ".glb")).string());
    }
  });
  return alabaster::run_app(app, argc, argv);
}
