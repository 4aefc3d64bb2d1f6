// What a run of the reference promises: the same picture whatever the threads and interruptions, parts that add up,
// errors that help.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "compare/compare.h"
#include "reference/reference.h"
#include "scene/error.h"
#include "scene/shapes.h"

namespace alabaster {
namespace {

Scene small_scene() {
  Scene scene;
  scene.path = "small.gltf";
  scene.environment.radiance = {0.5f, 0.6f, 0.7f};
  Object ball;
  ball.name = "ball";
  ball.role = Role::translucent;
  ball.mesh = icosphere(2);
  ball.medium.homogeneous = {{6, 4, 9}, {0.1, 0.3, 0.05}};
  ball.medium.g = 0.3;
  ball.eta = 1.3;
  scene.objects.push_back(ball);
  Object light;
  light.role = Role::emissive;
  light.mesh = transformed(flipped(quad(2, 2)), translation({0, 2, 0}));
  light.radiance = glm::vec3(5);
  scene.objects.push_back(light);
  Object floor;
  floor.mesh = transformed(quad(8, 8), translation({0, -1, 0}));
  scene.objects.push_back(floor);
  Camera camera;
  camera.name = "front";
  camera.to_world = look_at({0, 1, 4}, {0, 0, 0});
  scene.cameras.push_back(camera);
  return scene;
}

ReferenceOptions small_options() {
  ReferenceOptions options;
  options.width = 20;
  options.height = 14;
  options.samples = 12;
  return options;
}

std::string temporary(const std::string& name) {
  auto folder = std::filesystem::temp_directory_path() / ("alabaster_reference_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  return (folder / name).string();
}

TEST(ReferenceRun, LayersAddUpAndDescribeTheScene) {
  const Picture p = render_reference(small_scene(), small_options());
  for (const char* name : {"R", "G", "B"})
    for (std::size_t i = 0; i < p.channels.at(name).size(); ++i) {
      const std::string c(name);
      EXPECT_NEAR(
          p.channels.at(c)[i],
          p.channels.at("multiple." + c)[i] + p.channels.at("single." + c)[i] + p.channels.at("surface." + c)[i], 1e-5);
      EXPECT_TRUE(std::isfinite(p.channels.at("variance." + c)[i]));
    }
  const std::size_t middle = 7 * 20 + 10;
  EXPECT_EQ(p.channels.at("object.Y")[middle], 1);
  EXPECT_GT(p.channels.at("multiple.R")[middle], 0);
  EXPECT_GT(p.channels.at("surface.R")[middle], 0);
  EXPECT_NEAR(p.channels.at("Z")[middle], std::sqrt(17.0) - 1, 0.05);
  EXPECT_EQ(p.channels.at("object.Y")[0], 0);
  EXPECT_EQ(p.channels.at("multiple.R")[0], 0);
  EXPECT_EQ(std::get<double>(p.attributes.at("samplesPerPixel")), 12);
  EXPECT_EQ(std::get<double>(p.attributes.at("cappedPaths")), 0);
  EXPECT_EQ(std::get<double>(p.attributes.at("leakedPaths")), 0);
}

TEST(ReferenceRun, ComponentsCanBeChosen) {
  const Picture all = render_reference(small_scene(), small_options());
  ReferenceOptions options = small_options();
  options.surface = options.single = false;
  const Picture multiple = render_reference(small_scene(), options);
  EXPECT_EQ(multiple.channels.at("R"), all.channels.at("multiple.R"));
  EXPECT_FALSE(multiple.has("surface.R"));
}

// The noise that is reported (and that --noise stops at) is that of the chosen layers, not of all.
TEST(ReferenceRun, NoiseIsThatOfTheChosenComponents) {
  ReferenceOptions options = small_options();
  options.surface = options.multiple = false;
  const Picture p = render_reference(small_scene(), options);
  double variance = 0, mean = 0, count = 0;
  for (const char* channel : {"R", "G", "B"})
    for (std::size_t i = 0; i < p.channels.at("object.Y").size(); ++i) {
      if (p.channels.at("object.Y")[i] < 1) continue;
      variance += p.channels.at(std::string("variance.") + channel)[i];
      mean += p.channels.at(channel)[i];
      ++count;
    }
  EXPECT_NEAR(std::get<double>(p.attributes.at("noise")), std::sqrt(variance * count) / mean,
              1e-4 * std::sqrt(variance * count) / mean);
}

TEST(ReferenceRun, ThreadsDoNotChangeABit) {
  ReferenceOptions options = small_options();
  options.threads = 1;
  const Picture one = render_reference(small_scene(), options);
  options.threads = 2;
  EXPECT_EQ(render_reference(small_scene(), options).channels, one.channels);
  options.seed = 1;
  EXPECT_NE(render_reference(small_scene(), options).channels.at("R"), one.channels.at("R"));
}

TEST(ReferenceRun, ResumedIsTheSameBits) {
  ReferenceOptions options = small_options();
  options.samples = 24;
  const Picture whole = render_reference(small_scene(), options);
  options.state_path = temporary("part.state");
  std::filesystem::remove(options.state_path);
  options.progress = [](const ReferenceProgress&) { return false; };  // stops after its first pass
  const Picture part = render_reference(small_scene(), options);
  EXPECT_LT(std::get<double>(part.attributes.at("samplesPerPixel")), 24);
  EXPECT_TRUE(std::filesystem::exists(options.state_path));
  options.progress = nullptr;
  options.resume = true;
  options.threads = 1;
  const Picture resumed = render_reference(small_scene(), options);
  EXPECT_EQ(resumed.channels, whole.channels);
  EXPECT_EQ(std::get<double>(resumed.attributes.at("samplesPerPixel")), 24);
  EXPECT_FALSE(std::filesystem::exists(options.state_path));
}

TEST(ReferenceRun, StateOfAnotherSceneIsRefused) {
  ReferenceOptions options = small_options();
  options.state_path = temporary("other.state");
  options.keep_state = options.resume = true;
  std::filesystem::remove(options.state_path);
  render_reference(small_scene(), options);
  {
    std::fstream file(options.state_path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(7);
    file.put('1');
  }
  try {
    render_reference(small_scene(), options);
    ADD_FAILURE() << "sums without the layers' squares were taken";
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("another version"), std::string::npos) << error.what();
  }
  std::filesystem::remove(options.state_path);
  render_reference(small_scene(), options);
  Scene changed = small_scene();
  changed.objects[0].medium.g = 0.31;
  EXPECT_THROW(render_reference(changed, options), UserError);
  std::filesystem::resize_file(options.state_path, std::filesystem::file_size(options.state_path) - 8);
  EXPECT_THROW(render_reference(small_scene(), options), UserError);
  std::ofstream(options.state_path) << "nonsense";
  EXPECT_THROW(render_reference(small_scene(), options), UserError);
}

TEST(ReferenceRun, MergeIsOneLongerRun) {
  ReferenceOptions options = small_options();
  options.samples = 8;
  const Picture a = render_reference(small_scene(), options);
  options.seed = 7;
  options.samples = 24;
  const Picture b = render_reference(small_scene(), options);
  const Picture merged = merge({a, b}, {"a.exr", "b.exr"});
  EXPECT_EQ(std::get<double>(merged.attributes.at("samplesPerPixel")), 32);
  EXPECT_EQ(std::get<std::string>(merged.attributes.at("seed")), "0+7");
  for (std::size_t i = 0; i < 20 * 14; ++i) {
    for (const std::string channel : {"G", "multiple.G", "single.G", "surface.G"}) {
      const double mean_a = a.channels.at(channel)[i], mean_b = b.channels.at(channel)[i],
                   mean = merged.channels.at(channel)[i];
      EXPECT_NEAR(mean, (8 * mean_a + 24 * mean_b) / 32, 1e-5 * mean) << channel;
      // From first principles: sums of squares of both parts.
      const double squares = a.channels.at("variance." + channel)[i] * 8.0 * 7 + 8 * mean_a * mean_a +
                             b.channels.at("variance." + channel)[i] * 24.0 * 23 + 24 * mean_b * mean_b;
      const double expected = (squares - 32 * mean * mean) / (32.0 * 31);
      EXPECT_NEAR(merged.channels.at("variance." + channel)[i], expected, 1e-4 * expected + 1e-6) << channel;
    }
  }
  EXPECT_EQ(merged.channels.at("Z"), a.channels.at("Z"));
  EXPECT_THROW(merge({a, a}, {"a.exr", "a.exr"}), UserError);
  EXPECT_THROW(merge({merged, b}, {"m.exr", "b.exr"}), UserError);
  Scene changed = small_scene();
  changed.objects[0].eta = 1.31;
  EXPECT_THROW(merge({a, render_reference(changed, options)}, {"a.exr", "c.exr"}), UserError);
  EXPECT_THROW(merge({Picture{20, 14, {}, {}}}, {"x.exr"}), UserError);
  EXPECT_THROW(merge({}, {}), UserError);
}

// The variances that a picture gives are those that pictures of other seeds have, in the mean over its pixels: few
// samples, so that a wrong divisor (n for n - 1: 14 %) shows.
TEST(ReferenceRun, VariancesAreTheScatterOverSeeds) {
  ReferenceOptions options = small_options();
  options.samples = 8;
  const int seeds = 100;
  const std::vector<std::string> names{"R", "subsurface.R", "multiple.R", "single.R", "surface.R"};
  const std::size_t pixels = 20 * 14;
  std::vector<std::vector<double>> sum(names.size(), std::vector<double>(pixels, 0.0)), square = sum;
  std::vector<double> given(names.size(), 0.0);
  for (int seed = 0; seed < seeds; ++seed) {
    options.seed = static_cast<std::uint64_t>(seed);
    const Picture p = render_reference(small_scene(), options);
    for (std::size_t k = 0; k < names.size(); ++k)
      for (std::size_t i = 0; i < pixels; ++i) {
        const double value = names[k] == "subsurface.R" ? p.channels.at("R")[i] - p.channels.at("surface.R")[i]
                                                        : p.channels.at(names[k])[i];
        sum[k][i] += value;
        square[k][i] += value * value;
        given[k] += static_cast<double>(p.channels.at("variance." + names[k])[i]) / seeds;
      }
  }
  for (std::size_t k = 0; k < names.size(); ++k) {
    double scatter = 0;
    for (std::size_t i = 0; i < pixels; ++i) scatter += (square[k][i] - sum[k][i] * sum[k][i] / seeds) / (seeds - 1);
    EXPECT_GT(scatter, 0) << names[k];
    EXPECT_NEAR(given[k], scatter, 0.05 * scatter) << names[k];
  }
}

TEST(ReferenceRun, NoiseTargetStopsTheRun) {
  ReferenceOptions options = small_options();
  options.samples = 100000;
  options.noise = 0.1;
  const Picture p = render_reference(small_scene(), options);
  const double noise = std::get<double>(p.attributes.at("noise"));
  EXPECT_LE(noise, 0.1);
  EXPECT_GT(noise, 0.05);
  // The variance layers say the same over the same pixels.
  EXPECT_NEAR(compare(p, p).z->noise / std::sqrt(2.0), noise, 1e-4);
}

TEST(ReferenceRun, ErrorsNameTheOption) {
  ReferenceOptions options = small_options();
  options.camera = "back";
  EXPECT_THROW(render_reference(small_scene(), options), UserError);
  options = small_options();
  options.samples = 0;
  EXPECT_THROW(render_reference(small_scene(), options), UserError);
  options = small_options();
  options.width = 0;
  EXPECT_THROW(render_reference(small_scene(), options), UserError);
  Scene blind = small_scene();
  blind.cameras.clear();
  EXPECT_THROW(render_reference(blind, small_options()), UserError);
}

}  // namespace
}  // namespace alabaster
