// Shadow maps of all light samples, and the gather of the light that enters at receivers.
#pragma once

#include <memory>

#include "gpu/commands.h"
#include "lighting/lights.h"
#include "lighting/meshes.h"
#include "shared/lighting.h"

namespace alabaster {

struct LightSettings {
  int samples = 32;     // points on area lights
  int directions = 64;  // of the environment: those in which a uniform one may be blocked, or parts of its picture
  int map_size = 512;   // texels along a shadow map's edge
};

/// The lights of one scene. Use: make it, record the shadow maps, then gather or shade as often as wanted.
class Lighting {
 public:
  /// Samples the lights and uploads them. Throws UserError for settings out of range, gpu::DeviceError where the maps
  /// do not fit. `meshes` must live as long.
  Lighting(gpu::Context& context, const Scene& scene, const SceneMeshes& meshes, const LightSettings& settings = {});

  /// Draws every map (stage "shadow maps").
  void record_shadow_maps(gpu::Commands& commands) const;

  /// flux[i] = integral F_t(w) L (n.w) dw at receivers[i], W/m^2 per channel: Gamma_s of the report's Eq. 5 without the
  /// factor exp(-sigma_a / sigma_s'). `receivers` holds `count` Receiver (shared/lighting.h), `flux` as many vec3.
  /// `eta` is index inside / outside of their surface; with 1 it is plain irradiance. The environment may be left out.
  /// Stage "gather".
  void record_gather(gpu::Commands& commands, const gpu::Buffer& receivers, std::uint32_t count, double eta,
                     const gpu::Buffer& flux, bool environment = true) const;
  /// Irradiance as above from one in shares.size() of the light points: the first shares[0] receivers ask points 0, n,
  /// 2 n, ... for n of them each, the next shares[1] points 1, n + 1, ..., and so on.
  void record_shared_gather(gpu::Commands& commands, const gpu::Buffer& receivers,
                            const std::vector<std::uint32_t>& shares, const gpu::Buffer& irradiance) const;

  /// What a shader that includes lighting/gather.glsl needs.
  gpu::Bindings bindings() const;

  const SceneMeshes& meshes() const { return meshes_; }
  const LightSamples& samples() const { return samples_; }
  std::uint32_t maps() const { return static_cast<std::uint32_t>(views_.size()); }
  const gpu::Image& shadow_maps() const { return shadow_maps_; }
  /// The environment's picture (one texel where it is uniform) for shaders that include lighting/environment.glsl, and
  /// what it is turned by.
  gpu::Binding environment_binding() const { return {"environment_picture", environment_, nearest_}; }
  float environment_turn() const { return environment_turn_; }

 private:
  struct View {
    glm::mat4 to_clip;
    int skip;  // object that casts no shadow in it: the light itself; -1 none
  };
  struct Gather;
  void record(gpu::Commands& commands, const Gather& gather) const;
  void record_points(gpu::Commands& commands, const gpu::Bindings& bindings, GatherPush push) const;
  void record_directions(gpu::Commands& commands, const gpu::Bindings& bindings, GatherPush push) const;
  void make_views(const Scene& scene, const LightSettings& settings);
  void upload_environment(const Environment& environment);

  gpu::Context& context_;
  const SceneMeshes& meshes_;
  LightSamples samples_;
  std::vector<View> views_;
  std::vector<glm::uvec2> point_maps_;  // first and number, of each light point
  std::vector<bool> closed_;            // by object
  gpu::Buffer lights_, view_buffer_;
  gpu::Image shadow_maps_;
  gpu::Image environment_;
  float environment_turn_ = 0;
  gpu::Sampler compare_, nearest_;
  gpu::RasterPass closed_casters_, open_casters_;
  std::unique_ptr<gpu::Pass> gather_[3];  // by part, those that the lights need
};

}  // namespace alabaster
