#include "scene/vol.h"

#include <cmath>
#include <cstring>

#include "scene/error.h"
#include "scene/files.h"

namespace alabaster {
namespace {

struct Header {
  char magic[3] = {'V', 'O', 'L'};
  std::uint8_t version = 3;
  std::int32_t encoding = 1;  // 32-bit float
  std::int32_t size[3];       // cells
  std::int32_t channels;
  float box[6] = {0, 0, 0, 1, 1, 1};
};
static_assert(sizeof(Header) == 48);

constexpr std::int32_t largest_edge = 4096;  // cells; keeps the product of all below 2^40

}  // namespace

Grid read_vol(const std::string& path) {
  std::string bytes = read_file(path);
  auto fail = [&](const std::string& what) { throw UserError(path + ": " + what); };
  Header header;
  if (bytes.size() < sizeof header)
    fail("a .vol file has at least 48 bytes, this one has " + std::to_string(bytes.size()));
  std::memcpy(&header, bytes.data(), sizeof header);
  if (std::memcmp(header.magic, "VOL", 3) != 0) fail("not a Mitsuba .vol file (it does not begin with VOL)");
  if (header.version != 3) fail(".vol version " + std::to_string(header.version) + "; only version 3 is read");
  if (header.encoding != 1) fail(".vol encoding " + std::to_string(header.encoding) + "; write it as 32-bit float (1)");
  if (header.channels != 1 && header.channels != 3)
    fail("has " + std::to_string(header.channels) + " channels; a .vol must have 1 or 3");
  std::size_t count = header.channels;
  for (std::int32_t edge : header.size) {
    if (edge < 1 || edge > largest_edge)
      fail("grid size " + std::to_string(edge) + " is outside 1.." + std::to_string(largest_edge));
    count *= edge;
  }
  if (bytes.size() != sizeof header + count * sizeof(float))
    fail("wrong size: its header promises " + std::to_string(sizeof header + count * sizeof(float)) +
         " bytes, it has " + std::to_string(bytes.size()) + "; write it again");
  Grid grid{{header.size[0], header.size[1], header.size[2]}, header.channels, std::vector<float>(count)};
  std::memcpy(grid.values.data(), bytes.data() + sizeof header, count * sizeof(float));
  for (std::size_t i = 0; i < count; ++i)
    if (!std::isfinite(grid.values[i]))
      fail("value " + std::to_string(i) + " is not a finite number; every one must be");
  return grid;
}

void write_vol(const Grid& grid, const std::string& path) {
  Header header;
  for (int axis = 0; axis < 3; ++axis) header.size[axis] = grid.size[axis];
  header.channels = grid.channels;
  std::string bytes(reinterpret_cast<const char*>(&header), sizeof header);
  bytes.append(reinterpret_cast<const char*>(grid.values.data()), grid.values.size() * sizeof(float));
  write_file(path, bytes);
}

}  // namespace alabaster
