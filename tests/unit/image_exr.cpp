#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <random>

#include "image/picture.h"
#include "scene/error.h"

namespace alabaster {
namespace {

std::string temporary(const std::string& name) {
  auto folder = std::filesystem::temp_directory_path() / ("alabaster_image_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  return (folder / name).string();
}

Picture noise(int width, int height, std::vector<std::string> names) {
  Picture picture{width, height, {}, {}};
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0, 3);
  for (const std::string& name : names)
    for (float& v : picture.plane(name)) v = uniform(random);
  return picture;
}

TEST(ImageExr, FloatRoundTripIsExact) {
  Picture out = noise(37, 23, {"R", "G", "B", "multiple.R", "Z", "object.Y", "variance.B"});
  out.attributes["samplesPerPixel"] = 1234567.0;
  out.attributes["transport"] = std::string("report");
  write_exr(out, temporary("a.exr"));
  Picture in = read_exr(temporary("a.exr"));
  EXPECT_EQ(in.width, 37);
  EXPECT_EQ(in.height, 23);
  EXPECT_EQ(in.channels, out.channels);
  EXPECT_EQ(in.attributes, out.attributes);
}

TEST(ImageExr, HalfRoundsAndKeepsWhatDoesNotFit) {
  Picture out = noise(8, 8, {"R", "Z"});
  out.plane("Z")[5] = 1e6f;
  write_exr(out, temporary("h.exr"), true);
  Picture in = read_exr(temporary("h.exr"));
  EXPECT_EQ(in.channels["Z"], out.channels["Z"]);
  EXPECT_NE(in.channels["R"], out.channels["R"]);
  for (std::size_t i = 0; i < 64; ++i) EXPECT_NEAR(in.channels["R"][i], out.channels["R"][i], 2e-3);
}

TEST(ImageExr, ReadsTiledFilesAndShiftedDataWindows) {
  const int w = 50, h = 40;
  std::vector<float> values(w * h);
  for (int i = 0; i < w * h; ++i) values[i] = static_cast<float>(i);
  Imf::Header header(Imath::Box2i({0, 0}, {99, 99}), Imath::Box2i({10, 20}, {10 + w - 1, 20 + h - 1}));
  header.channels().insert("G", Imf::Channel(Imf::FLOAT));
  header.setTileDescription(Imf::TileDescription(16, 16));
  {
    Imf::TiledOutputFile file(temporary("t.exr").c_str(), header);
    Imf::FrameBuffer pixels;
    pixels.insert("G", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data() - 20 * w - 10), 4, 4 * w));
    file.setFrameBuffer(pixels);
    file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
  }
  Picture in = read_exr(temporary("t.exr"));
  ASSERT_EQ(in.width, w);
  ASSERT_EQ(in.height, h);
  EXPECT_EQ(in.channels["G"], values);
}

TEST(ImageExr, ErrorsNameTheFileAndLeaveNothing) {
  EXPECT_THROW(
      try { read_exr("/nonexistent/x.exr"); } catch (const UserError& e) {
        EXPECT_NE(std::string(e.what()).find("/nonexistent/x.exr"), std::string::npos);
        throw;
      },
      UserError);
  std::ofstream(temporary("broken.exr")) << "not a picture";
  EXPECT_THROW(read_exr(temporary("broken.exr")), UserError);
  Picture picture = noise(4, 4, {"R"});
  EXPECT_THROW(write_exr(picture, "/nonexistent/x.exr"), UserError);
  EXPECT_THROW(write_exr(Picture{}, temporary("empty.exr")), UserError);
  EXPECT_FALSE(std::filesystem::exists(temporary("empty.exr")));
}

TEST(ImageExr, AFrameIsWrittenQuickly) {
  std::vector<std::string> names;
  for (int i = 0; i < 25; ++i) names.push_back("layer" + std::to_string(i) + ".R");
  Picture picture = noise(640, 480, names);
  auto start = std::chrono::steady_clock::now();
  write_exr(picture, temporary("big.exr"));
  double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  RecordProperty("seconds", std::to_string(seconds));
  std::printf("640x480, 25 channels of noise: %.3f s\n", seconds);
  EXPECT_LT(seconds, 5.0);  // a guard against the wrong codec, not a benchmark: the machine may be busy
}

TEST(ImagePng, EncodesSrgbAndFilmic) {
  Picture picture{2, 1, {}, {}};
  for (const char* c : {"R", "G", "B"}) picture.plane(c) = {0.5f, 20.0f};
  write_png(picture, temporary("a.png"));
  write_png(picture, temporary("b.png"), -1.0, Curve::filmic);
  EXPECT_GT(std::filesystem::file_size(temporary("a.png")), 50u);
  std::ifstream file(temporary("a.png"), std::ios::binary);
  std::string magic(8, ' ');
  file.read(magic.data(), 8);
  EXPECT_EQ(magic, "\x89PNG\r\n\x1a\n");
  EXPECT_THROW(write_png(noise(2, 2, {"Z"}), temporary("c.png")), UserError);
  EXPECT_FALSE(std::filesystem::exists(temporary("c.png")));
}

}  // namespace
}  // namespace alabaster
