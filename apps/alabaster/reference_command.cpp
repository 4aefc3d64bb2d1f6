#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>

#include "arguments.h"
#include "commands.h"
#include "reference/reference.h"
#include "scene/error.h"
#include "scene/load.h"

namespace alabaster {
namespace {

struct Arguments {
  std::string scene, output, size = "640x480";
  std::vector<std::string> components{"multiple", "single", "surface"};
  ReferenceOptions options;
};

void show_progress(const ReferenceProgress& p) {
  std::fprintf(stderr, "\r%3.0f %%, %.1f samples a pixel, %.0f s", 100 * p.share, p.samples, p.seconds);
  if (p.seconds_left >= 0) std::fprintf(stderr, ", %.0f s left", p.seconds_left);
  std::fprintf(stderr, "   ");
}

void run(const Arguments& a) {
  ReferenceOptions options = a.options;
  const glm::ivec2 size = parse_size(a.size);
  options.width = size.x, options.height = size.y;
  const auto wants = [&](const char* name) {
    return std::find(a.components.begin(), a.components.end(), name) != a.components.end();
  };
  options.multiple = wants("multiple"), options.single = wants("single"), options.surface = wants("surface");
  options.state_path = a.output + ".state";
  options.keep_state = options.resume;
  check_writable(a.output);
  const bool terminal = isatty(STDERR_FILENO);
  if (terminal)
    options.progress = [](const ReferenceProgress& p) {
      show_progress(p);
      return true;
    };
  const Scene scene = load_scene(a.scene);
  print_warnings(scene);
  const Picture picture = render_reference(scene, options);
  if (terminal) std::fputc('\n', stderr);
  write_exr(picture, a.output);
}

}  // namespace

void add_reference(CLI::App& app) {
  auto* command = app.add_subcommand("reference", "path-traced reference of a scene");
  auto a = std::make_shared<Arguments>();
  command->add_option("scene", a->scene, "glTF 2.0 scene (.glb, .gltf)")->required();
  command->add_option("-o,--output", a->output, "picture (EXR)")->required();
  command->add_option("--spp", a->options.samples, "samples a pixel")
      ->check(CLI::Range(1, 1 << 24))
      ->capture_default_str();
  command->add_option("--noise", a->options.noise, "stop at this relative standard error over the object's pixels")
      ->check(CLI::Range(0.0, 1.0));
  command->add_option("--size", a->size, "WIDTHxHEIGHT, pixels")->capture_default_str();
  command->add_option("--camera", a->options.camera, "its name (default: the first)");
  command->add_option("--components", a->components, "multiple,single,surface")
      ->delimiter(',')
      ->check(CLI::IsMember({"multiple", "single", "surface"}));
  const std::map<std::string, Guiding> guidings{
      {"automatic", Guiding::automatic}, {"always", Guiding::always}, {"never", Guiding::never}};
  command
      ->add_option("--guiding", a->options.guiding,
                   "look for lamps through refracting surfaces: automatic, always, never; changes the noise alone")
      ->transform(CLI::CheckedTransformer(guidings));
  command->add_option("--seed", a->options.seed, "of the random numbers")->capture_default_str();
  command->add_option("--threads", a->options.threads, "0: all")->check(CLI::NonNegativeNumber)->capture_default_str();
  command->add_flag("--resume", a->options.resume,
                    "go on where an earlier run of the same command stopped, and keep its state (OUTPUT.state)");
  command->callback([a] { run(*a); });
}

}  // namespace alabaster
