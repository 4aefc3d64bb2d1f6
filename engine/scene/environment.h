// Light from infinity: the same from everywhere, or a latitude-longitude picture of it.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

namespace alabaster {

/// Radiance that is constant over each texel of a latitude-longitude picture; shared/environment.h says which direction
/// is where. Drawn from in proportion to the mean of its channels.
class EnvironmentPicture {
 public:
  /// `radiance`: width * height, W/m^2/sr, rows from the top, finite and not negative, not all zero. `turn`: about +y,
  /// counter-clockwise from above, in whole turns.
  EnvironmentPicture(glm::ivec2 size, std::vector<glm::vec3> radiance, float turn = 0);

  glm::ivec2 size() const { return size_; }
  float turn() const { return turn_; }
  const std::vector<glm::vec3>& texels() const { return radiance_; }
  const glm::vec3& texel(glm::ivec2 at) const { return radiance_[index(at)]; }
  double solid_angle(int row) const;  // of one texel, sr

  glm::ivec2 texel_of(glm::vec3 direction) const;
  glm::vec3 radiance(glm::vec3 direction) const { return texel(texel_of(direction)); }  // W/m^2/sr
  /// The direction at (u, v) of the picture, both 0..1 from its top left.
  glm::dvec3 direction(glm::dvec2 place) const;

  /// A direction with density(), 1/sr, from four numbers in [0, 1).
  glm::vec3 draw(glm::vec4 chance) const;
  float density(glm::vec3 direction) const;

  double total() const { return total_; }  // integral of the mean channel over all directions, W/m^2
  /// (mean)^2 / (mean square) over all directions: 1 where it is uniform, small where little of it shines.
  double evenness() const { return evenness_; }
  bool grey() const { return grey_; }

 private:
  std::size_t index(glm::ivec2 at) const {
    return static_cast<std::size_t>(at.y) * static_cast<std::size_t>(size_.x) + static_cast<std::size_t>(at.x);
  }
  glm::ivec2 size_;
  std::vector<glm::vec3> radiance_;
  float turn_;
  std::vector<float> columns_;  // in each row, running share of its texels
  std::vector<float> rows_;     // running share
  double total_ = 0, evenness_ = 1;
  bool grey_ = true;
};

struct Environment {
  glm::vec3 radiance{0};                              // W/m^2/sr from everywhere, where there is no picture
  std::shared_ptr<const EnvironmentPicture> picture;  // null: none

  bool dark() const { return !picture && radiance == glm::vec3(0); }
  bool grey() const { return picture ? picture->grey() : radiance.r == radiance.g && radiance.g == radiance.b; }
  glm::vec3 at(glm::vec3 direction) const { return picture ? picture->radiance(direction) : radiance; }
};

/// Reads a latitude-longitude EXR with channels R, G, B, times `scale`. Throws UserError where it is missing, no EXR,
/// without those channels, NaN, infinite, negative or black.
std::shared_ptr<const EnvironmentPicture> read_environment_picture(const std::string& path, double scale, double turn);

}  // namespace alabaster
