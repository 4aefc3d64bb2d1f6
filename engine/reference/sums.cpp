#include "reference/sums.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "image/whole_file.h"
#include "scene/error.h"
#include "shared/procedural.h"

namespace alabaster {
namespace {

// The last one counts the layouts: 1 had no squares of the layers.
constexpr char magic[8] = {'a', 'l', 'a', 'b', 's', 'u', 'm', '2'};
struct StateHeader {
  char magic[8];
  std::int64_t width, height;
  std::uint64_t fingerprint, samples, events, capped, leaks;
  double seconds;
};

double variance_of_mean(double sum, double square, double n) {
  if (n < 2) return 0;
  return std::max(0.0, (square - sum * sum / n) / (n * (n - 1)));
}

template <class T>
std::uint64_t hash_of(const std::vector<T>& values, std::uint64_t so_far) {
  return fingerprint_of(values.data(), values.size() * sizeof(T), so_far);
}
template <class T>
std::uint64_t hash_of(const T& value, std::uint64_t so_far) {
  return fingerprint_of(&value, sizeof value, so_far);
}
std::uint64_t hash_grid(const std::shared_ptr<const Grid>& grid, std::uint64_t so_far) {
  if (!grid) return hash_of(0, so_far);
  so_far = hash_of(grid->size, hash_of(grid->channels, hash_of(grid->trilinear, so_far)));
  return hash_of(grid->values, so_far);
}

}  // namespace

void PixelSums::add(const PathSample& sample, const std::array<bool, layer_count>& chosen) {
  glm::dvec3 sum(0), subsurface(0);
  for (std::size_t layer = 0; layer < layer_count; ++layer) {
    const glm::dvec3 value(sample.radiance[layer]);
    for (std::size_t c = 0; c < 3; ++c) {
      layers[3 * layer + c] += value[static_cast<int>(c)];
      layer_squares[3 * layer + c] += value[static_cast<int>(c)] * value[static_cast<int>(c)];
    }
    if (!chosen[layer]) continue;
    sum += value;
    if (layer != static_cast<std::size_t>(Layer::surface)) subsurface += value;
  }
  for (std::size_t c = 0; c < 3; ++c) {
    square[c] += sum[static_cast<int>(c)] * sum[static_cast<int>(c)];
    subsurface_square[c] += subsurface[static_cast<int>(c)] * subsurface[static_cast<int>(c)];
  }
  on_object += sample.on_object;
}

double Sums::relative_error(const std::array<bool, layer_count>& chosen) const {
  const double n = static_cast<double>(samples);
  if (n < 2) return 0;
  double variance[2] = {0, 0}, mean[2] = {0, 0};  // over all pixels, over the object's
  for (const PixelSums& p : pixels)
    for (std::size_t c = 0; c < 3; ++c) {
      double sum = 0;
      for (std::size_t layer = 0; layer < layer_count; ++layer)
        if (chosen[layer]) sum += p.layers[3 * layer + c];
      const double v = variance_of_mean(sum, p.square[c], n);
      for (std::size_t where = 0; where < 2; ++where) {
        if (where == 1 && p.on_object < n) continue;
        variance[where] += v;
        mean[where] += sum / n;
      }
    }
  const bool any = mean[1] > 0;
  double count = 0;
  for (const PixelSums& p : pixels) count += any ? (p.on_object < n ? 0 : 3) : 3;
  return mean[any] > 0 ? std::sqrt(variance[any] * count) / mean[any] : 0;
}

void Sums::write_layers(Picture& picture, const std::array<bool, layer_count>& chosen) const {
  static const char* const rgb[3] = {"R", "G", "B"};
  static const char* const names[layer_count] = {"multiple.", "single.", "surface."};
  const double n = std::max(1.0, static_cast<double>(samples));
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<float>& total = picture.plane(rgb[c]);
    std::vector<float>& variance = picture.plane(std::string("variance.") + rgb[c]);
    std::vector<float>& below = picture.plane(std::string("variance.subsurface.") + rgb[c]);
    for (std::size_t layer = 0; layer < layer_count; ++layer) {
      if (!chosen[layer]) continue;
      const std::string name = names[layer] + std::string(rgb[c]);
      std::vector<float>& plane = picture.plane(name);
      std::vector<float>& own = picture.plane("variance." + name);
      for (std::size_t i = 0; i < pixels.size(); ++i) {
        const double sum = pixels[i].layers[3 * layer + c];
        plane[i] = static_cast<float>(sum / n);
        own[i] = static_cast<float>(variance_of_mean(sum, pixels[i].layer_squares[3 * layer + c], n));
      }
    }
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      double sum = 0, subsurface = 0;
      for (std::size_t layer = 0; layer < layer_count; ++layer) {
        const double value = chosen[layer] ? pixels[i].layers[3 * layer + c] : 0;
        sum += value;
        if (layer != static_cast<std::size_t>(Layer::surface)) subsurface += value;
      }
      total[i] = static_cast<float>(sum / n);
      variance[i] = static_cast<float>(variance_of_mean(sum, pixels[i].square[c], n));
      below[i] = static_cast<float>(variance_of_mean(subsurface, pixels[i].subsurface_square[c], n));
    }
  }
  std::vector<float>& object = picture.plane("object.Y");
  for (std::size_t i = 0; i < pixels.size(); ++i) object[i] = static_cast<float>(pixels[i].on_object / n);
}

void Sums::save(const std::string& path) const {
  StateHeader header{{}, width, height, fingerprint, samples, events, capped, leaks, seconds};
  std::memcpy(header.magic, magic, sizeof magic);
  write_whole_file(path, [&](const std::string& temporary) {
    std::ofstream file(temporary, std::ios::binary);
    file.exceptions(std::ios::failbit | std::ios::badbit);
    file.write(reinterpret_cast<const char*>(&header), sizeof header);
    file.write(reinterpret_cast<const char*>(pixels.data()),
               static_cast<std::streamsize>(pixels.size() * sizeof(PixelSums)));
    file.close();
  });
}

bool Sums::load(const std::string& path) {
  if (!std::filesystem::exists(path)) return false;
  std::ifstream file(path, std::ios::binary);
  StateHeader header{};
  file.read(reinterpret_cast<char*>(&header), sizeof header);
  const auto bytes = static_cast<std::streamsize>(pixels.size() * sizeof(PixelSums));
  if (file && std::memcmp(header.magic, magic, sizeof magic - 1) == 0 && header.magic[7] != magic[7])
    throw UserError(path + ": was made by another version of this program; remove it to start anew");
  if (!file || std::memcmp(header.magic, magic, sizeof magic) != 0)
    throw UserError(path + ": is not a state file of the reference; remove it to start anew");
  if (header.width != width || header.height != height || header.fingerprint != fingerprint)
    throw UserError(path +
                    ": was made with another scene, size, camera, seed or choice of components; use the same, or "
                    "remove it to start anew");
  file.read(reinterpret_cast<char*>(pixels.data()), bytes);
  if (!file || file.gcount() != bytes || file.peek() != std::ifstream::traits_type::eof())
    throw UserError(path + ": is incomplete; remove it to start anew");
  samples = header.samples;
  events = header.events;
  capped = header.capped;
  leaks = header.leaks;
  seconds = header.seconds;
  return true;
}

std::uint64_t fingerprint_of(const void* data, std::size_t bytes, std::uint64_t so_far) {
  const auto* p = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < bytes; ++i) so_far = (so_far ^ p[i]) * 0x100000001b3u;
  return so_far;
}

std::uint64_t fingerprint_of(const Scene& scene) {
  std::uint64_t hash = hash_of(scene.environment.radiance, 0xcbf29ce484222325u);
  if (scene.environment.picture)
    hash = hash_of(scene.environment.picture->texels(),
                   hash_of(scene.environment.picture->size(), hash_of(scene.environment.picture->turn(), hash)));
  for (const PunctualLight& light : scene.lights) {
    hash = hash_of(light.kind, hash_of(light.intensity, hash_of(light.position, hash_of(light.direction, hash))));
    hash = hash_of(light.inner_cone, hash_of(light.outer_cone, hash_of(light.radius, hash)));
  }
  for (const Object& o : scene.objects) {
    hash = hash_of(o.mesh.positions, hash_of(o.mesh.triangles, hash_of(o.role, hash)));
    hash = hash_of(o.medium.homogeneous.sigma_s, hash_of(o.medium.homogeneous.sigma_a, hash_of(o.medium.g, hash)));
    hash = hash_grid(o.medium.sigma_t, hash_grid(o.medium.albedo, hash));
    hash = hash_grid(o.medium.sigma_s, hash_grid(o.medium.sigma_a, hash));
    if (o.medium.solid) hash = hash_of(*o.medium.solid, hash);
    hash = hash_of(o.medium.scale, hash_of(o.medium.world_to_box, hash));
    if (o.roughness > 0) hash = hash_of(o.roughness, hash);
    hash = hash_of(o.eta, hash_of(o.albedo, hash_of(o.radiance, hash_of(o.two_sided, hash))));
  }
  return hash;
}

}  // namespace alabaster
