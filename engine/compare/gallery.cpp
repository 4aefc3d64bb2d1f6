#include "compare/gallery.h"

#include <algorithm>

#include "compare/canvas.h"
#include "scene/error.h"

namespace alabaster {
namespace {

using Planes = std::array<std::vector<float>, 3>;

constexpr int jpeg_quality = 88;
constexpr int gap = 6;  // px between rows and between columns

Planes planes_of(const Shown& shown, int width, int height, const std::string& path) {
  const Picture& picture = shown.picture;
  if (picture.width != width || picture.height != height || !picture.has("R") || !picture.has("G") || !picture.has("B"))
    throw UserError(path + ": the picture '" + shown.caption +
                    "' has another size than the first or no R, G, B; make all with the same --size");
  return {picture.channels.at("R"), picture.channels.at("G"), picture.channels.at("B")};
}

double exposure_by(const Shown& reference, const Planes& planes) {
  std::vector<unsigned char> mask(planes[0].size(), 1);
  const auto object = reference.picture.channels.find("object.Y");
  if (object != reference.picture.channels.end())
    std::transform(object->second.begin(), object->second.end(), mask.begin(),
                   [](float cover) { return static_cast<unsigned char>(cover > 0.999f); });
  if (std::find(mask.begin(), mask.end(), 1) == mask.end()) std::fill(mask.begin(), mask.end(), 1);
  return exposure_of(planes, mask);
}

}  // namespace

void write_gallery(const std::vector<GalleryRow>& rows, int columns, const std::string& path) {
  if (rows.empty() || rows.front().empty() || columns < 1)
    throw UserError(path + ": there is no picture to show; name a scene");
  const int width = rows.front().front().picture.width, height = rows.front().front().picture.height;
  std::size_t longest = 0;
  for (const GalleryRow& row : rows) longest = std::max(longest, row.size());
  const int row_width = width * static_cast<int>(longest) + gap, row_height = height + line_height + gap;
  const int lines = (static_cast<int>(rows.size()) + columns - 1) / columns;
  Canvas canvas(columns * row_width - gap, lines * row_height - gap);
  for (int r = 0; r < static_cast<int>(rows.size()); ++r) {
    const GalleryRow& row = rows[static_cast<std::size_t>(r)];
    const double gain = exposure_by(row.back(), planes_of(row.back(), width, height, path));
    int x = r % columns * row_width;
    const int y = r / columns * row_height;
    for (const Shown& shown : row) {
      const Planes planes = planes_of(shown, width, height, path);
      draw(canvas, {x, y, width, height, 1}, [&](std::size_t i) {
        return Colour{gain * planes[0][i], gain * planes[1][i], gain * planes[2][i]};
      });
      write_text(canvas, x + 4, y + height + 3, shown.caption);
      x += width;
    }
  }
  if (path.ends_with(".png"))
    write_png_rgb8(canvas.width, canvas.height, canvas.rgb, path);
  else
    write_jpeg_rgb8(canvas.width, canvas.height, canvas.rgb, jpeg_quality, path);
}

}  // namespace alabaster
