#include "reference/reference.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <mutex>

#include "reference/sums.h"
#include "scene/error.h"

namespace alabaster {
namespace {

constexpr int samples_between_checks =
    16;  // of the noise: at fixed numbers of samples, so that the end does not depend on the clock
constexpr double pass_seconds = 2;  // aimed at
constexpr double progress_seconds = 0.2;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

const Camera& camera_of(const Scene& scene, const std::string& name) {
  if (scene.cameras.empty()) throw UserError(scene.path + ": has no camera; add one to the glTF file");
  if (name.empty()) return scene.cameras.front();
  std::string known;
  for (const Camera& camera : scene.cameras) {
    if (camera.name == name) return camera;
    known += (known.empty() ? "" : ", ") + camera.name;
  }
  throw UserError(scene.path + ": has no camera named " + name + "; choose --camera from: " + known);
}

class Renderer {
 public:
  Renderer(const Scene& scene, const ReferenceOptions& options)
      : scene_(scene),
        options_(options),
        camera_(camera_of(scene, options.camera)),
        world_(scene, options.guiding),
        chosen_{options.multiple, options.single, options.surface} {
    eye_ = glm::vec3(camera_.to_world[3]);
    camera_inside_ = world_.inside_at(eye_);
    sums_.width = options.width;
    sums_.height = options.height;
    sums_.pixels.resize(static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height));
    sums_.fingerprint = fingerprint();
    if (options.resume && keeps_state()) sums_.load(options.state_path);
  }

  Picture run() {
    start_ = now();
    seconds_before_ = sums_.seconds;
    double saved = start_;
    check_noise();
    std::uint64_t pass = 1;
    while (!done() && !stop_) {
      const double begin = now();
      pass = std::min(pass, samples_to_check());
      render_pass(pass);
      check_noise();
      report(0);
      const double each = std::max(now() - begin, 1e-6) / static_cast<double>(pass);
      pass =
          static_cast<std::uint64_t>(std::clamp(pass_seconds / each, 1.0, static_cast<double>(samples_between_checks)));
      if (keeps_state() && now() - saved > options_.state_seconds) {
        sums_.save(options_.state_path);
        saved = now();
      }
    }
    if (keeps_state() && (stop_ || options_.keep_state)) sums_.save(options_.state_path);
    if (keeps_state() && !stop_ && !options_.keep_state) std::filesystem::remove(options_.state_path);
    return picture();
  }

 private:
  bool keeps_state() const { return !options_.state_path.empty(); }
  std::uint64_t target() const { return static_cast<std::uint64_t>(options_.samples); }
  bool quiet() const { return options_.noise > 0 && noise_ > 0 && noise_ <= options_.noise; }
  bool done() const { return sums_.samples >= target() || quiet(); }
  std::uint64_t samples_to_check() const {
    return std::min(target() - sums_.samples, samples_between_checks - sums_.samples % samples_between_checks);
  }
  void check_noise() {
    sums_.seconds = seconds_before_ + now() - start_;
    if (sums_.samples % samples_between_checks == 0) noise_ = sums_.relative_error(chosen_);
  }

  void render_pass(std::uint64_t samples) {
    const auto pixels = sums_.pixels.size();
    std::atomic<std::uint64_t> events{0}, capped{0}, leaks{0}, finished{0};
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, pixels, 16), [&](const tbb::blocked_range<std::size_t>& range) {
          std::uint64_t own_events = 0, own_capped = 0, own_leaks = 0;
          for (std::size_t pixel = range.begin(); pixel < range.end(); ++pixel)
            for (std::uint64_t k = 0; k < samples; ++k) {
              Random random(options_.seed, pixel, sums_.samples + k);
              const float x = random.uniform(), y = random.uniform();
              const PathSample sample = trace_path(world_, eye_, ray_through(pixel, x, y), camera_inside_, random);
              sums_.pixels[pixel].add(sample, chosen_);
              own_events += sample.events;
              own_capped += sample.capped;
              own_leaks += static_cast<std::uint64_t>(sample.leaks);
            }
          events += own_events;
          capped += own_capped;
          leaks += own_leaks;
          finished += range.size();
          report(static_cast<double>(samples) * static_cast<double>(finished) / static_cast<double>(pixels));
        });
    sums_.samples += samples;
    sums_.events += events;
    sums_.capped += capped;
    sums_.leaks += leaks;
  }

  // Box filter: (x, y) in the pixel's unit square.
  glm::vec3 ray_through(std::size_t pixel, float x, float y) const {
    const auto width = static_cast<std::size_t>(options_.width);
    const float across = (static_cast<float>(pixel % width) + x) / static_cast<float>(options_.width) - 0.5f;
    const float down = (static_cast<float>(pixel / width) + y) / static_cast<float>(options_.height) - 0.5f;
    const float tall = 2 * std::tan(0.5f * camera_.y_fov);
    const float wide = tall * static_cast<float>(options_.width) / static_cast<float>(options_.height);
    return glm::normalize(glm::mat3(camera_.to_world) * glm::vec3(wide * across, -tall * down, -1));
  }

  // `under_way`: samples per pixel of the pass that is running; 0 between passes.
  void report(double under_way) {
    if (!options_.progress) return;
    std::unique_lock<std::mutex> turn(reporting_, std::try_to_lock);
    if (!turn || now() - reported_ < progress_seconds) return;
    reported_ = now();
    ReferenceProgress p;
    p.samples = static_cast<double>(sums_.samples) + under_way;
    p.noise = noise_;
    p.share = p.samples / static_cast<double>(options_.samples);
    if (options_.noise > 0 && noise_ > 0)
      p.share = std::max(p.share, std::min(1.0, options_.noise * options_.noise / (noise_ * noise_)));
    p.seconds = now() - start_;
    const double all = seconds_before_ + p.seconds;
    if (p.share > 0) p.seconds_left = all / p.share - all;
    if (!options_.progress(p)) stop_ = true;
  }

  void write_first_surface(Picture& picture) const {
    std::vector<float>* normal[3] = {&picture.plane("N.X"), &picture.plane("N.Y"), &picture.plane("N.Z")};
    std::vector<float>& depth = picture.plane("Z");
    for (std::size_t pixel = 0; pixel < sums_.pixels.size(); ++pixel) {
      const glm::vec3 direction = ray_through(pixel, 0.5f, 0.5f);
      Hit hit;
      if (!world_.next_surface(eye_, direction, INFINITY, camera_inside_, {}, hit)) continue;
      for (int c = 0; c < 3; ++c) (*normal[c])[pixel] = hit.normal[c];
      depth[pixel] = hit.distance;
    }
  }

  Picture picture() const {
    Picture picture{options_.width, options_.height, {}, {}};
    sums_.write_layers(picture, chosen_);
    write_first_surface(picture);
    const double paths = static_cast<double>(sums_.samples) * static_cast<double>(sums_.pixels.size());
    picture.attributes = {{"samplesPerPixel", static_cast<double>(sums_.samples)},
                          {"seed", std::to_string(options_.seed)},
                          {"camera", camera_.name},
                          {"scene", scene_.path},
                          {"sceneFingerprint", std::to_string(scene_fingerprint())},
                          {"seconds", sums_.seconds},
                          {"threads", static_cast<double>(tbb::this_task_arena::max_concurrency())},
                          {"eventsPerSample", static_cast<double>(sums_.events) / std::max(1.0, paths)},
                          {"cappedPaths", static_cast<double>(sums_.capped)},
                          {"leakedPaths", static_cast<double>(sums_.leaks)},
                          {"noise", sums_.relative_error(chosen_)}};
    return picture;
  }

  // What parts that may be merged have in common.
  std::uint64_t scene_fingerprint() const {
    std::uint64_t hash = fingerprint_of(scene_);
    hash = fingerprint_of(&camera_.to_world, sizeof camera_.to_world, hash);
    hash = fingerprint_of(&camera_.y_fov, sizeof camera_.y_fov, hash);
    return fingerprint_of(chosen_.data(), sizeof chosen_, hash);
  }
  std::uint64_t fingerprint() const {
    const std::uint64_t hash = fingerprint_of(&options_.guiding, sizeof options_.guiding, scene_fingerprint());
    return fingerprint_of(&options_.seed, sizeof options_.seed, hash);
  }

  const Scene& scene_;
  const ReferenceOptions& options_;
  const Camera& camera_;
  World world_;
  std::array<bool, layer_count> chosen_;
  glm::vec3 eye_{0};
  Inside camera_inside_;
  Sums sums_;
  double noise_ = 0, start_ = 0, seconds_before_ = 0, reported_ = 0;
  std::mutex reporting_;
  std::atomic<bool> stop_{false};
};

}  // namespace

Picture render_reference(const Scene& scene, const ReferenceOptions& options) {
  if (options.width <= 0 || options.height <= 0) throw UserError("--size: must be at least 1x1");
  if (options.samples <= 0) throw UserError("--spp: must be at least 1");
  if (!(options.noise >= 0)) throw UserError("--noise: must be 0 (never stop early) or a positive share, such as 0.01");
  if (options.threads < 0) throw UserError("--threads: must be 0 (all) or more");
  tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
  return arena.execute([&] { return Renderer(scene, options).run(); });
}

}  // namespace alabaster
