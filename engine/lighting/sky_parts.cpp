#include "lighting/sky_parts.h"

#include <algorithm>
#include <cmath>
#include <queue>

namespace alabaster {
namespace {

constexpr int finest_rows = 128;  // coarse pictures are cut between their texels, too

/// The picture's texels, each cut `cuts` times `cuts`.
class Texels {
 public:
  explicit Texels(const EnvironmentPicture& picture)
      : picture_(picture), cuts_(std::max(1, finest_rows / picture.size().y)), size_(picture.size() * cuts_) {
    for (int y = 0; y < size_.y; ++y) solid_angles_.push_back(solid_angle(y));
  }
  glm::ivec2 size() const { return size_; }
  glm::dvec3 light(glm::ivec2 at) const {  // W/m^2
    return glm::dvec3(picture_.texel(at / cuts_)) * solid_angles_[static_cast<std::size_t>(at.y)];
  }
  double power(glm::ivec2 at) const {
    const glm::dvec3 v = light(at);
    return (v.r + v.g + v.b) / 3;
  }
  glm::dvec3 direction(glm::ivec2 at) const { return picture_.direction((glm::dvec2(at) + 0.5) / glm::dvec2(size_)); }
  /// Width of a texel and height, radians.
  glm::dvec2 extent(double row) const { return {2 * M_PI / size_.x * std::sin(M_PI * row / size_.y), M_PI / size_.y}; }

 private:
  double solid_angle(int row) const {
    return 2 * M_PI / size_.x * (std::cos(M_PI * row / size_.y) - std::cos(M_PI * (row + 1) / size_.y));
  }
  const EnvironmentPicture& picture_;
  int cuts_;
  glm::ivec2 size_;
  std::vector<double> solid_angles_;
};

struct Rectangle {
  glm::ivec2 low{0}, high{0};  // texels; high is past the last
  double power = 0;
  int longest = 0;  // axis
  double urgency = 0;
  bool operator<(const Rectangle& other) const { return urgency < other.urgency; }
};

/// Power of each row or column of the rectangle.
std::vector<double> profile(const Texels& texels, const Rectangle& r, int axis) {
  std::vector<double> sums(static_cast<std::size_t>(r.high[axis] - r.low[axis]));
  for (int y = r.low.y; y < r.high.y; ++y)
    for (int x = r.low.x; x < r.high.x; ++x) {
      const glm::ivec2 at(x, y);
      sums[static_cast<std::size_t>(at[axis] - r.low[axis])] += texels.power(at);
    }
  return sums;
}

Rectangle measured(const Texels& texels, glm::ivec2 low, glm::ivec2 high) {
  Rectangle r{low, high};
  for (double power : profile(texels, r, 1)) r.power += power;
  const double equator = 0.5 * texels.size().y;
  const glm::dvec2 extent = glm::dvec2(high - low) * texels.extent(std::clamp(equator, 1.0 * low.y, 1.0 * high.y));
  r.longest = extent.x > extent.y ? 0 : 1;
  if (high[r.longest] - low[r.longest] < 2) r.longest = 1 - r.longest;
  if (high[r.longest] - low[r.longest] >= 2) r.urgency = r.power * glm::length(extent);
  return r;
}

SkyPart summed_up(const Texels& texels, const Rectangle& r) {
  glm::dvec3 middle(0), flux(0);
  double second[3][3] = {};
  for (int y = r.low.y; y < r.high.y; ++y)
    for (int x = r.low.x; x < r.high.x; ++x) {
      const double power = texels.power({x, y});
      if (power <= 0) continue;
      const glm::dvec3 d = texels.direction({x, y});
      middle += power * d;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) second[i][j] += power * d[i] * d[j];
    }
  const double length = glm::length(middle);
  const glm::dvec3 direction = middle / length;
  for (int y = r.low.y; y < r.high.y; ++y)
    for (int x = r.low.x; x < r.high.x; ++x)
      flux += texels.light({x, y}) * glm::dot(texels.direction({x, y}), direction);
  // Variance of the directions at right angles to the middle one, the mean of the two axes; an even strip of the same
  // variance reaches sqrt(3) of its root to either side.
  double along = 0, all = 0;
  for (int i = 0; i < 3; ++i) {
    all += second[i][i];
    for (int j = 0; j < 3; ++j) along += direction[i] * second[i][j] * direction[j];
  }
  const double variance = std::max(0.0, (all - along) / r.power / 2);
  return {glm::vec3(direction), glm::vec3(flux), static_cast<float>(std::sqrt(3 * variance))};
}

}  // namespace

std::vector<SkyPart> cut_sky(const EnvironmentPicture& picture, int count) {
  const Texels texels(picture);
  std::priority_queue<Rectangle> rectangles;
  std::vector<Rectangle> done;
  rectangles.push(measured(texels, {0, 0}, texels.size()));
  while (!rectangles.empty()) {
    const Rectangle r = rectangles.top();
    rectangles.pop();
    if (r.urgency <= 0 || static_cast<int>(rectangles.size() + done.size()) + 1 >= count) {
      done.push_back(r);
      continue;
    }
    const std::vector<double> sums = profile(texels, r, r.longest);
    double below = 0;
    int cut = 0;
    while (cut < static_cast<int>(sums.size()) && below + 0.5 * sums[static_cast<std::size_t>(cut)] < 0.5 * r.power)
      below += sums[static_cast<std::size_t>(cut++)];
    glm::ivec2 high = r.high, low = r.low;
    high[r.longest] = low[r.longest] = r.low[r.longest] + std::clamp(cut, 1, static_cast<int>(sums.size()) - 1);
    rectangles.push(measured(texels, r.low, high));
    rectangles.push(measured(texels, low, r.high));
  }
  std::vector<SkyPart> parts;
  for (const Rectangle& r : done)
    if (r.power > 0) parts.push_back(summed_up(texels, r));
  return parts;
}

}  // namespace alabaster
