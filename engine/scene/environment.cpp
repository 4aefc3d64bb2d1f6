#include "scene/environment.h"

#include <algorithm>
#include <cmath>

#include "image/picture.h"
#include "scene/error.h"
#include "shared/environment.h"

namespace alabaster {
namespace {

double mean(glm::vec3 v) { return (static_cast<double>(v.r) + v.g + v.b) / 3; }

/// Ends at 1; a list without any share is even.
void make_running(std::vector<double>& shares, float* out) {
  double sum = 0, so_far = 0;
  for (double share : shares) sum += share;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    so_far += sum > 0 ? shares[i] / sum : 1.0 / static_cast<double>(shares.size());
    out[i] = static_cast<float>(so_far);
  }
  out[shares.size() - 1] = 1;
}

int pick(const float* running, int count, float chance) {
  return std::min(static_cast<int>(std::upper_bound(running, running + count, chance) - running), count - 1);
}

}  // namespace

EnvironmentPicture::EnvironmentPicture(glm::ivec2 size, std::vector<glm::vec3> radiance, float turn)
    : size_(size), radiance_(std::move(radiance)), turn_(turn), columns_(radiance_.size()), rows_(size.y) {
  std::vector<double> of_row(size.y), of_texel(size.x);
  double square = 0;
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      const glm::vec3 value = texel({x, y});
      grey_ = grey_ && value.r == value.g && value.g == value.b;
      of_texel[x] = mean(value) * solid_angle(y);
      of_row[y] += of_texel[x];
      square += of_texel[x] * mean(value);
    }
    make_running(of_texel, &columns_[index({0, y})]);
    total_ += of_row[y];
  }
  make_running(of_row, rows_.data());
  evenness_ = square > 0 ? total_ * total_ / (4 * M_PI * square) : 1;
}

double EnvironmentPicture::solid_angle(int row) const {
  return 2 * M_PI / size_.x * (std::cos(M_PI * row / size_.y) - std::cos(M_PI * (row + 1) / size_.y));
}

glm::ivec2 EnvironmentPicture::texel_of(glm::vec3 direction) const {
  const glm::vec2 place(environment_column(direction.x, direction.z, turn_), environment_row(direction.y));
  return glm::clamp(glm::ivec2(place * glm::vec2(size_)), glm::ivec2(0), size_ - 1);
}

glm::dvec3 EnvironmentPicture::direction(glm::dvec2 place) const {
  const double across = 2 * M_PI * (place.x - 0.5 - turn_), down = M_PI * place.y;
  return {std::sin(down) * std::sin(across), std::cos(down), -std::sin(down) * std::cos(across)};
}

glm::vec3 EnvironmentPicture::draw(glm::vec4 chance) const {
  const int y = pick(rows_.data(), size_.y, chance.x), x = pick(&columns_[index({0, y})], size_.x, chance.y);
  // Even over the texel's solid angle: in its column, and in the cosine from the pole.
  const double top = std::cos(M_PI * y / size_.y), bottom = std::cos(M_PI * (y + 1) / size_.y);
  const double row = std::acos(glm::mix(top, bottom, static_cast<double>(chance.w))) / M_PI;
  return glm::vec3(direction({(x + static_cast<double>(chance.z)) / size_.x, row}));
}

float EnvironmentPicture::density(glm::vec3 direction) const {
  return static_cast<float>(mean(radiance(direction)) / total_);
}

std::shared_ptr<const EnvironmentPicture> read_environment_picture(const std::string& path, double scale, double turn) {
  const Picture picture = read_exr(path);
  for (const char* channel : {"R", "G", "B"})
    if (!picture.has(channel)) throw UserError(path + ": has no channel " + channel + "; write it as R, G, B");
  std::vector<glm::vec3> radiance(picture.channels.at("R").size());
  bool dark = true;
  for (std::size_t i = 0; i < radiance.size(); ++i) {
    const char* const names[] = {"R", "G", "B"};
    for (int c = 0; c < 3; ++c) {
      const float value = picture.channels.at(names[c])[i] * static_cast<float>(scale);
      const auto width = static_cast<std::size_t>(picture.width);
      const std::string where =
          path + ": pixel (" + std::to_string(i % width) + ", " + std::to_string(i / width) + ") channel " + names[c];
      if (!std::isfinite(value)) throw UserError(where + " is not a finite number; paint it over");
      if (value < 0) throw UserError(where + " is negative; raise it to 0");
      radiance[i][c] = value;
      dark = dark && value == 0;
    }
  }
  if (dark) throw UserError(path + ": is black everywhere; give a picture with light or leave the environment out");
  return std::make_shared<EnvironmentPicture>(glm::ivec2(picture.width, picture.height), std::move(radiance),
                                              static_cast<float>(turn));
}

}  // namespace alabaster
