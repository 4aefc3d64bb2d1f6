// A medium as the inner loop wants it: floats, flat arrays, and majorants for delta tracking.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "reference/random.h"
#include "scene/scene.h"

namespace alabaster {

struct Optics {
  glm::vec3 sigma_t{0};  // sigma_s + sigma_a, 1/m
  glm::vec3 sigma_s{0};  // 1/m
};

/// Flattened scene Medium. Coefficients that vary are sampled as Medium::at() does, in float.
class FlatMedium {
 public:
  FlatMedium() = default;
  explicit FlatMedium(const Medium& medium);

  bool empty() const { return empty_; }       // neither scatters nor absorbs
  bool varies() const { return varies_; }     // over space
  bool grey_flight() const { return grey_; }  // sigma_t is the same in the three channels everywhere
  float g() const { return g_; }
  float least_sigma_t() const { return least_; }  // over space and channels, 1/m
  const Optics& homogeneous() const { return uniform_; }
  glm::vec3 mean_free_path() const { return mean_free_path_; }  // m, homogeneous media
  /// Of a collision in a homogeneous medium whose flight the channel `hero` sampled: sigma_s, and sigma_t, over its
  /// sigma_t.
  glm::vec3 scattered(int hero) const { return scattered_[hero]; }
  glm::vec3 density(int hero) const { return density_[hero]; }
  Optics at(glm::vec3 world) const;

 private:
  friend class Candidates;
  void make_majorants(const std::vector<const Grid*>& grids);
  void add_majorants(const Grid& grid);
  void bound_solid();
  bool empty_ = true, grey_ = true;
  float g_ = 0, scale_ = 1, least_ = 0;
  Optics uniform_;
  glm::vec3 mean_free_path_{0};
  glm::mat3 scattered_{0}, density_{0};
  bool varies_ = false;
  std::shared_ptr<const Grid> sigma_t_grid_, albedo_grid_;
  std::shared_ptr<const Grid> sigma_s_grid_, sigma_a_grid_;
  std::shared_ptr<const ProceduralSolid> solid_;
  std::shared_ptr<const Grid> depth_;
  glm::mat4 to_box_{1}, to_depth_{1};
  glm::ivec3 blocks_{1};
  std::vector<float> majorants_;  // largest sigma_t in a block over the channels, 1/m; x fastest
};

/// The candidate collisions of delta tracking and ratio tracking along a ray in a medium that varies: a Poisson process
/// whose rate is the local majorant of blocks of cells, walked block by block (E. Woodcock 1965; L. Szirmay-Kalos et
/// al. 2011 for the local majorants). Beyond the box the outermost blocks go on for ever, as the grid's own clamping
/// does.
class Candidates {
 public:
  Candidates(const FlatMedium& medium, glm::vec3 origin, glm::vec3 direction, Random& random);
  /// Advances to the next candidate no further than `limit` (m); false when there is none, and then a later call with a
  /// larger limit goes on from there.
  bool next(float limit);
  float distance() const { return distance_; }  // m
  float majorant() const { return majorant_; }  // at the candidate, 1/m

 private:
  void step_block();
  float rate() const;
  const FlatMedium& medium_;
  Random& random_;
  glm::ivec3 block_{0}, step_{0};
  glm::vec3 crossing_{0}, per_block_{0};  // distance to the next block face of each axis, and between faces, m
  float distance_ = 0, depth_left_ = 0, majorant_ = 0;
};

}  // namespace alabaster
