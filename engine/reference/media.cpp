#include "reference/media.h"

#include <algorithm>

#include "scene/procedural.h"

namespace alabaster {
namespace {

constexpr int most_blocks = 32;  // along an axis
constexpr float infinity = INFINITY;

std::size_t cell_index(const Grid& grid, glm::ivec3 cell) {
  return (static_cast<std::size_t>(cell.z) * static_cast<std::size_t>(grid.size.y) + static_cast<std::size_t>(cell.y)) *
             static_cast<std::size_t>(grid.size.x) +
         static_cast<std::size_t>(cell.x);
}

glm::vec3 cell_value(const Grid& grid, glm::ivec3 cell) {
  const float* v = grid.values.data() + cell_index(grid, cell) * static_cast<std::size_t>(grid.channels);
  return grid.channels == 1 ? glm::vec3(v[0]) : glm::vec3(v[0], v[1], v[2]);
}

glm::vec3 sample(const Grid& grid, glm::vec3 unit_cube) {
  const glm::vec3 size(grid.size);
  if (!grid.trilinear)
    return cell_value(grid, glm::clamp(glm::ivec3(glm::floor(unit_cube * size)), glm::ivec3(0), grid.size - 1));
  const glm::vec3 position = glm::clamp(unit_cube * size - 0.5f, glm::vec3(0), size - 1.0f);
  const glm::ivec3 low(position), high = glm::min(low + 1, grid.size - 1);
  const glm::vec3 w = position - glm::vec3(low);
  glm::vec3 plane[2];
  for (int k = 0; k < 2; ++k) {
    const int z = k ? high.z : low.z;
    const glm::vec3 near = glm::mix(cell_value(grid, {low.x, low.y, z}), cell_value(grid, {high.x, low.y, z}), w.x);
    const glm::vec3 far = glm::mix(cell_value(grid, {low.x, high.y, z}), cell_value(grid, {high.x, high.y, z}), w.x);
    plane[k] = glm::mix(near, far, w.y);
  }
  return glm::mix(plane[0], plane[1], w.z);
}

float largest(glm::vec3 v) { return std::max(v.x, std::max(v.y, v.z)); }
float smallest(glm::vec3 v) { return std::min(v.x, std::min(v.y, v.z)); }

}  // namespace

FlatMedium::FlatMedium(const Medium& medium) : g_(static_cast<float>(medium.g)) {
  uniform_.sigma_s = glm::vec3(medium.homogeneous.sigma_s);
  uniform_.sigma_t = glm::vec3(medium.homogeneous.sigma_s + medium.homogeneous.sigma_a);
  empty_ = uniform_.sigma_t == glm::vec3(0);
  grey_ = uniform_.sigma_t.x == uniform_.sigma_t.y && uniform_.sigma_t.y == uniform_.sigma_t.z;
  least_ = smallest(uniform_.sigma_t);
  mean_free_path_ = 1.0f / uniform_.sigma_t;
  for (int hero = 0; hero < 3; ++hero) {
    if (uniform_.sigma_t[hero] <= 0) continue;  // no collision is ever sampled by it
    scattered_[hero] = uniform_.sigma_s / uniform_.sigma_t[hero];
    density_[hero] = uniform_.sigma_t / uniform_.sigma_t[hero];
  }
  varies_ = medium.heterogeneous();
  if (!varies_) return;
  to_box_ = glm::mat4(medium.world_to_box);
  scale_ = static_cast<float>(medium.scale);
  sigma_t_grid_ = medium.sigma_t;
  albedo_grid_ = medium.albedo;
  sigma_s_grid_ = medium.sigma_s;
  sigma_a_grid_ = medium.sigma_a;
  solid_ = medium.solid;
  depth_ = medium.depth;
  to_depth_ = glm::mat4(medium.world_to_depth);
  grey_ = sigma_t_grid_ ? sigma_t_grid_->channels == 1 : medium.grey();
  if (sigma_t_grid_)
    make_majorants({sigma_t_grid_.get()});
  else if (sigma_s_grid_)
    make_majorants({sigma_s_grid_.get(), sigma_a_grid_.get()});
  else
    bound_solid();
}

// The same everywhere: noise has no smaller bound over a block than over all.
void FlatMedium::bound_solid() {
  float most = 0;
  least_ = infinity;
  for (const SolidPart& part : solid_->parts) {
    most = std::max(most, largest(part.sigma_s + part.sigma_a));
    least_ = std::min(least_, smallest(part.sigma_s + part.sigma_a));
  }
  majorants_ = {most * 1.00001f};
  empty_ = most <= 0;
}

// Over one block, the sum of what each grid has at the most there. Blocks are of the first grid's cells, or fewer.
void FlatMedium::make_majorants(const std::vector<const Grid*>& grids) {
  blocks_ = glm::min(grids[0]->size, glm::ivec3(most_blocks));
  majorants_.assign(
      static_cast<std::size_t>(blocks_.x) * static_cast<std::size_t>(blocks_.y) * static_cast<std::size_t>(blocks_.z),
      0.0f);
  least_ = 0;
  for (const Grid* grid : grids) add_majorants(*grid);
  empty_ = *std::max_element(majorants_.begin(), majorants_.end()) <= 0;
}

void FlatMedium::add_majorants(const Grid& grid) {
  float least = infinity;
  std::size_t index = 0;
  for (int z = 0; z < blocks_.z; ++z)
    for (int y = 0; y < blocks_.y; ++y)
      for (int x = 0; x < blocks_.x; ++x, ++index) {
        // A block's points interpolate between its own cells and one more on each side.
        const glm::ivec3 block(x, y, z);
        const glm::ivec3 first = glm::max(block * grid.size / blocks_ - 1, glm::ivec3(0));
        const glm::ivec3 last = glm::min(((block + 1) * grid.size + blocks_ - 1) / blocks_, grid.size - 1);
        float most = 0;
        for (int k = first.z; k <= last.z; ++k)
          for (int j = first.y; j <= last.y; ++j)
            for (int i = first.x; i <= last.x; ++i) {
              const glm::vec3 value = scale_ * cell_value(grid, {i, j, k});
              // One part in 1e5 above: interpolation in float must never exceed it.
              most = std::max(most, largest(value) * 1.00001f);
              least = std::min(least, smallest(value));
            }
        majorants_[index] += most;
      }
  least_ += least;
}

Optics FlatMedium::at(glm::vec3 world) const {
  if (!varies_) return uniform_;
  const glm::vec3 u(to_box_ * glm::vec4(world, 1.0f));
  Optics optics;
  if (solid_) {
    const float below = depth_ ? sample(*depth_, glm::vec3(to_depth_ * glm::vec4(world, 1.0f))).x : 0.0f;
    const SolidCoefficients<float> c = solid_at<float>(*solid_, u, below);
    return {c.sigma_s + c.sigma_a, c.sigma_s};
  }
  if (sigma_s_grid_) {
    optics.sigma_s = scale_ * sample(*sigma_s_grid_, u);
    optics.sigma_t = optics.sigma_s + scale_ * sample(*sigma_a_grid_, u);
    return optics;
  }
  optics.sigma_t = scale_ * sample(*sigma_t_grid_, u);
  optics.sigma_s = optics.sigma_t * (albedo_grid_ ? sample(*albedo_grid_, u) : glm::vec3(1));
  return optics;
}

Candidates::Candidates(const FlatMedium& medium, glm::vec3 origin, glm::vec3 direction, Random& random)
    : medium_(medium), random_(random), depth_left_(random.exponential()) {
  const glm::vec3 position = glm::vec3(medium.to_box_ * glm::vec4(origin, 1.0f)) * glm::vec3(medium.blocks_);
  const glm::vec3 speed = glm::vec3(medium.to_box_ * glm::vec4(direction, 0.0f)) * glm::vec3(medium.blocks_);
  for (int axis = 0; axis < 3; ++axis) {
    const int last = medium.blocks_[axis] - 1;
    block_[axis] = std::clamp(
        static_cast<int>(std::floor(std::clamp(position[axis], -1.0f, static_cast<float>(last) + 1.0f))), 0, last);
    step_[axis] = speed[axis] > 0 ? 1 : -1;
    per_block_[axis] = speed[axis] != 0 ? 1.0f / std::abs(speed[axis]) : infinity;
    const bool ends = step_[axis] > 0 ? block_[axis] == last : block_[axis] == 0;
    const float face = static_cast<float>(block_[axis] + (step_[axis] > 0 ? 1 : 0));
    crossing_[axis] = ends || speed[axis] == 0 ? infinity : (face - position[axis]) / speed[axis];
  }
}

float Candidates::rate() const {
  const glm::ivec3 n = medium_.blocks_;
  return medium_.majorants_[(static_cast<std::size_t>(block_.z) * static_cast<std::size_t>(n.y) +
                             static_cast<std::size_t>(block_.y)) *
                                static_cast<std::size_t>(n.x) +
                            static_cast<std::size_t>(block_.x)];
}

void Candidates::step_block() {
  const int axis =
      crossing_.x <= crossing_.y ? (crossing_.x <= crossing_.z ? 0 : 2) : (crossing_.y <= crossing_.z ? 1 : 2);
  block_[axis] += step_[axis];
  const bool ends = step_[axis] > 0 ? block_[axis] == medium_.blocks_[axis] - 1 : block_[axis] == 0;
  crossing_[axis] = ends ? infinity : crossing_[axis] + per_block_[axis];
}

bool Candidates::next(float limit) {
  for (;;) {
    majorant_ = rate();
    const float face = std::min(crossing_.x, std::min(crossing_.y, crossing_.z));
    const float end = std::min(face, limit), span = std::max(0.0f, end - distance_);
    if (majorant_ * span > depth_left_) {
      distance_ += depth_left_ / majorant_;
      depth_left_ = random_.exponential();
      return true;
    }
    if (end == infinity) return false;  // nothing out there for ever
    depth_left_ -= majorant_ * span;
    distance_ = std::max(distance_, end);
    if (limit <= face) return false;
    step_block();
  }
}

}  // namespace alabaster
