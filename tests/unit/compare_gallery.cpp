#include <gtest/gtest.h>

#include <filesystem>

#include "compare/gallery.h"
#include "scene/error.h"
#include "scene/files.h"
#include "support/pictures.h"
#include "support/temp_folder.h"

namespace alabaster {
namespace {

/// Width and height of a baseline JPEG (ITU-T T.81, B.2.2: marker SOF0).
std::pair<int, int> jpeg_size(const std::string& bytes) {
  const std::size_t at = bytes.find("\xff\xc0");
  if (bytes.rfind("\xff\xd8", 0) != 0 || at == std::string::npos) return {0, 0};
  const auto byte = [&](std::size_t i) { return int(static_cast<unsigned char>(bytes.at(at + i))); };
  return {256 * byte(7) + byte(8), 256 * byte(5) + byte(6)};
}

TEST(Gallery, RowsStandInColumns) {
  const test::TempFolder folder;
  const Shown shown{"a", constant(40, 30, 1)};
  write_gallery({{shown, shown}, {shown, shown}, {shown, shown}}, 2, folder / "g.jpg");
  const auto [width, height] = jpeg_size(read_file(folder / "g.jpg"));
  EXPECT_EQ(width, 4 * 40 + 6);  // two pairs and a gap
  EXPECT_EQ(height, 2 * (30 + 14) + 6);
}

TEST(Gallery, RefusesUnlikeSizes) {
  const test::TempFolder folder;
  EXPECT_THROW(write_gallery({{{"a", constant(4, 3, 1)}, {"b", constant(3, 3, 1)}}}, 1, folder / "g.jpg"), UserError);
  EXPECT_THROW(write_gallery({}, 1, folder / "g.jpg"), UserError);
  EXPECT_FALSE(std::filesystem::exists(folder / "g.jpg"));
}

}  // namespace
}  // namespace alabaster
