// What the program does with scenes and options that are malformed or hostile: the right exit status, one clear line,
// no output file, no validation message, no crash.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "support/hostile.h"
#include "support/program.h"

namespace alabaster {
namespace {

std::vector<std::string> error_lines(const std::string& err) {
  std::vector<std::string> lines;
  std::size_t at = 0;
  while (at < err.size()) {
    const std::size_t end = std::min(err.find('\n', at), err.size());
    const std::string line = err.substr(at, end - at);
    if (line.rfind("warning: ", 0) != 0) lines.push_back(line);
    at = end + 1;
  }
  return lines;
}

void expect_refused(const test::Outcome& outcome, const std::string& output, const std::vector<std::string>& words) {
  EXPECT_EQ(outcome.status, 1) << outcome.err;
  const std::vector<std::string> lines = error_lines(outcome.err);
  ASSERT_EQ(lines.size(), 1u) << outcome.err;
  EXPECT_EQ(lines[0].rfind("alabaster: ", 0), 0u) << lines[0];
  for (const std::string& word : words)
    EXPECT_NE(lines[0].find(word), std::string::npos) << "no '" << word << "' in: " << lines[0];
  EXPECT_EQ(outcome.err.find("vulkan:"), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(output));
}

test::Outcome render(const std::string& scene, const std::string& output, std::vector<std::string> more = {},
                     const std::string& environment = "") {
  std::vector<std::string> words{"render", scene, "-o", output};
  for (const auto& [option, value] : {std::pair{"--size", "32x24"}, std::pair{"--grid", "16"}})
    if (std::find(more.begin(), more.end(), option) == more.end()) words.insert(words.end(), {option, value});
  words.insert(words.end(), more.begin(), more.end());
  return test::run_program("alabaster", words, environment);
}

class BadInput : public ::testing::Test {
 protected:
  test::TempFolder folder;
  std::string output = folder / "out.exr";
  std::string good() {
    const std::string path = folder / "good.glb";
    write_gltf(test::good_scene(), path);
    return path;
  }
};

TEST_F(BadInput, HostileScenesAreRefused) {
  for (const test::HostileScene& scene : test::make_hostile_scenes(folder / "")) {
    SCOPED_TRACE(scene.name);
    const test::Outcome outcome = render(scene.path, output);
    if (!scene.expect_ok) {
      expect_refused(outcome, output, scene.expected_words);
      continue;
    }
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(error_lines(outcome.err).empty()) << outcome.err;
    for (const std::string& word : scene.expected_words)
      EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
    EXPECT_TRUE(std::filesystem::exists(output));
    std::filesystem::remove(output);
  }
}

TEST_F(BadInput, GridsThatCannotBe) {
  for (const char* grid : {"0", "-5", "3", "100000", "1500"}) {
    SCOPED_TRACE(grid);
    expect_refused(render(good(), output, {"--grid", grid}), output, {"--grid", "choose"});
  }
}

TEST_F(BadInput, PlacesThatCannotBeWritten) {
  const std::string scene = good();
  expect_refused(render(scene, folder / "no-such-folder/out.exr"), folder / "no-such-folder/out.exr",
                 {"no-such-folder", "make it first"});
  expect_refused(render(scene, output, {"--stats", "/proc/stats.json"}), output, {"/proc/stats.json"});
  const test::Outcome outcome = test::run_program("alabaster", {"render", scene, "-o", folder / ""});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_NE(outcome.err.find("is a folder"), std::string::npos) << outcome.err;
}

TEST_F(BadInput, OptionsThatNameNothing) {
  const std::string scene = good();
  expect_refused(render(scene, output, {"--camera", "nobody"}), output, {"nobody", "it has: "});
  expect_refused(render(scene, output, {"--device", "no such device"}), output, {"no such device", "there are: "});
  expect_refused(render(scene, output, {"--size", "0x10"}), output, {"--size", "between"});
  expect_refused(render(scene, output, {"--size", "big"}), output, {"--size", "WIDTHxHEIGHT"});
  expect_refused(render(scene, output, {"--tolerance", "-1"}), output, {"--tolerance"});
}

TEST_F(BadInput, NoVulkanDriver) {
  expect_refused(render(good(), output, {}, "VK_DRIVER_FILES=/nowhere.json VK_ICD_FILENAMES=/nowhere.json"), output,
                 {"no Vulkan device", "install"});
}

TEST_F(BadInput, WrongUsageIsStatusTwo) {
  EXPECT_EQ(test::run_program("alabaster", {}).status, 2);
  EXPECT_EQ(test::run_program("alabaster", {"paint"}).status, 2);
  EXPECT_EQ(test::run_program("alabaster", {"render"}).status, 2);
  EXPECT_EQ(test::run_program("alabaster", {"render", "x.glb", "-o", output, "--no-such-option"}).status, 2);
  EXPECT_EQ(test::run_program("alabaster", {"render", "x.glb", "-o", output, "--transport", "magic"}).status, 2);
  EXPECT_EQ(test::run_program("alabaster", {"--help"}).status, 0);
}

TEST_F(BadInput, AFailedRenderKeepsTheOldPicture) {
  write_file(output, "the old picture");
  const test::Outcome outcome = render(folder / "missing.glb", output);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(read_file(output), "the old picture");
}

TEST_F(BadInput, CompareNamesWhatIsWrong) {
  write_file(folder / "broken.exr", "not an EXR");
  const test::Outcome outcome = test::run_program(
      "alabaster", {"compare", folder / "broken.exr", folder / "missing.exr", "-o", folder / "sheet.png"});
  expect_refused(outcome, folder / "sheet.png", {"broken.exr"});
}

}  // namespace
}  // namespace alabaster
