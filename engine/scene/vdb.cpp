#include "scene/vdb.h"

// OpenVDB's own headers, as system headers, warn about nothing.
#include <openvdb/openvdb.h>
#include <openvdb/tools/Dense.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "scene/error.h"
#include "scene/shapes.h"

namespace alabaster {
namespace {

constexpr std::int64_t most_voxels = 1 << 26;

/// The grids of one file that a medium wants.
class Source {
 public:
  Source(const std::string& path, const std::vector<std::string>& names) : path_(path) {
    if (!std::filesystem::is_regular_file(path)) fail("there is no such file");
    try {
      openvdb::initialize();
      openvdb::io::File file(path);
      file.open(false);  // no delayed loading: errors come here
      for (const std::string& name : names) {
        if (!file.hasGrid(name)) fail("has no grid '" + name + "'" + names_in(file));
        add(name, file.readGrid(name));
      }
    } catch (const UserError&) {
      throw;
    } catch (const std::exception& error) {
      fail("cannot be read (" + one_line(error.what()) + "); it may be damaged: write it again");
    }
    measure();
  }

  /// `channels` grids from `first` on, interleaved, times `factors`.
  std::shared_ptr<Grid> dense(std::size_t first, int channels, glm::dvec3 factors, bool trilinear) const {
    auto out = std::make_shared<Grid>();
    out->size = size();
    out->channels = channels;
    out->trilinear = trilinear;
    const std::size_t count = std::size_t(out->size.x) * std::size_t(out->size.y) * std::size_t(out->size.z);
    out->values.resize(count * channels);
    for (int c = 0; c < channels; ++c) {
      const std::size_t source = std::min(first + c, grids_.size() - 1);
      openvdb::tools::Dense<float, openvdb::tools::LayoutXYZ> voxels(box_);
      openvdb::tools::copyToDense(*grids_[source], voxels);
      for (std::size_t i = 0; i < count; ++i) {
        const float value = voxels.data()[i];
        if (!std::isfinite(value) || value < 0)
          fail("grid '" + names_[source] + "' holds " + (value < 0 ? "negative values" : "values that are not finite"));
        out->values[i * channels + c] = float(factors[c] * value);
      }
    }
    return out;
  }

  /// Position in the object's frame -> unit cube of the active voxels' box.
  glm::dmat4 to_box() const {
    const openvdb::Mat4R m = grids_[0]->transform().baseMap()->getAffineMap()->getMat4();  // row vectors
    glm::dmat4 index_to_object;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) index_to_object[i][j] = m[i][j];
    const openvdb::Coord low = box_.min();
    const glm::dmat4 out =
        glm::inverse(index_to_object * translation(glm::dvec3(low.x(), low.y(), low.z()) - 0.5) * scaling(size()));
    if (!std::isfinite(glm::determinant(out))) fail("its transform flattens the grid");
    return out;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw UserError(path_ + ": " + what); }

  static std::string one_line(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text.substr(0, 200);
  }

  static std::string names_in(const openvdb::io::File& file) {
    std::string known;
    for (auto name = file.beginName(); name != file.endName() && known.size() < 200; ++name)
      known += (known.empty() ? "; it has: " : ", ") + name.gridName();
    return known;
  }

  void add(const std::string& name, const openvdb::GridBase::Ptr& grid) {
    const auto floats = openvdb::gridPtrCast<openvdb::FloatGrid>(grid);
    if (!floats) fail("grid '" + name + "' holds no floats (" + grid->valueType() + "); write it as a float grid");
    if (!floats->transform().isLinear()) fail("grid '" + name + "' has a transform that is not affine");
    if (!grids_.empty() && floats->transform() != grids_[0]->transform())
      fail("grid '" + name + "' has another transform than '" + names_[0] + "'; write them with the same");
    names_.push_back(name);
    grids_.push_back(floats);
  }

  void measure() {
    for (const auto& grid : grids_) {
      const openvdb::CoordBBox box = grid->evalActiveVoxelBoundingBox();
      if (!box.empty()) box_.expand(box);
    }
    if (box_.empty()) fail("grid '" + names_[0] + "' has no active voxels");
    std::int64_t voxels = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t edge = std::int64_t(box_.max()[axis]) - std::int64_t(box_.min()[axis]) + 1;
      if (edge < 1 || edge > most_voxels || (voxels *= edge) > most_voxels)
        fail("its active voxels span more than " + std::to_string(most_voxels) + " voxels; resample it coarser");
    }
  }

  glm::ivec3 size() const {
    const openvdb::Coord size = box_.dim();
    return {size.x(), size.y(), size.z()};
  }

  std::string path_;
  std::vector<std::string> names_;
  std::vector<openvdb::FloatGrid::Ptr> grids_;
  openvdb::CoordBBox box_;
};

glm::dvec3 constants(const Fields& medium, const std::string& key) {
  const glm::dvec3 value = medium.rgb(key);
  if (glm::any(glm::lessThan(value, glm::dvec3(0)))) medium.fail(key, "must not be negative");
  return value;
}

}  // namespace

Medium read_vdb_medium(const Fields& medium) {
  Medium out;
  const bool by_density = medium.has("density");
  const std::vector<std::string> six = {"sigma_s.r", "sigma_s.g", "sigma_s.b", "sigma_a.r", "sigma_a.g", "sigma_a.b"};
  const std::vector<std::string> names = by_density ? std::vector{medium.text("density")} : six;
  const glm::dvec3 sigma_s = by_density ? constants(medium, "sigma_s") : glm::dvec3(1);
  const glm::dvec3 sigma_a = by_density ? constants(medium, "sigma_a") : glm::dvec3(1);
  const bool trilinear = medium.trilinear();
  out.scale = medium.number_or("scale", 1);
  if (out.scale <= 0) medium.fail("scale", "must be positive");
  const std::string path = (std::filesystem::path(medium.file()).parent_path() / medium.text("file")).string();
  try {
    const Source source(path, names);
    const auto grey = [](glm::dvec3 c) { return c.r == c.g && c.g == c.b; };
    const int channels = by_density && grey(sigma_s) && grey(sigma_a) ? 1 : 3;
    out.sigma_s = source.dense(0, channels, sigma_s, trilinear);
    out.sigma_a = source.dense(by_density ? 0 : 3, channels, sigma_a, trilinear);
    out.world_to_box = medium.has("bbox_min") ? medium.box() : source.to_box();
  } catch (const UserError& error) {
    if (std::string(error.what()).find(path) != 0) throw;
    medium.fail("file", std::string("cannot be used: ") + error.what());
  }
  return out;
}

}  // namespace alabaster
