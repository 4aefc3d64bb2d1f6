// Single scattering as a layer of its own (shared/single.h): radiance along the refracted view ray for the picture, and
// on the facets the flux that it carries out of the surface, which the query would send out a second time.
#pragma once

#include "diffusion/diffusion.h"
#include "lighting/facet_receivers.h"
#include "lighting/lighting.h"
#include "scene/scene.h"
#include "shared/single.h"

namespace alabaster {

/// Flux that leaves a half space of albedo 1 after one scattering, over the flux that entered as a beam of refracted
/// cosine `mu`: integral over the outside directions of (1 - F_r) p mu' / (mu + mu'), p Henyey-Greenstein.
double single_scattering_share(double mu, double eta, double g);

class SingleScattering {
 public:
  /// What is lit: index in Scene::objects, and that object's medium and index inside / outside.
  struct Subject {
    int object;
    const Medium& medium;
    double eta;
  };
  /// The references outlive this, but for the subject's.
  SingleScattering(gpu::Context& context, const Domain& domain, const Diffusion& diffusion, const Subject& subject);

  /// Of the lights: flux() and its images (stage "single flux"). The shadow maps of `lighting` must have been drawn.
  /// On each facet the flux below a plane, all scaled by scale().
  void prepare(const Lighting& lighting, const SceneMeshes& meshes);
  /// What leaves the object as the picture draws it over what would leave below planes: 1 but for curvature, and where
  /// light shines through thin parts. Per channel, of the last prepare().
  glm::vec3 scale() const { return scale_; }
  /// Takes flux() out of `gamma_s` (W/m^2, two vec3 a cut cell) and makes query_gamma() and entered() of both.
  void record_take(gpu::Commands& commands, const gpu::Buffer& gamma_s) const;

  /// W/m^2, two vec4 a cut cell: leaves after one scattering.
  const gpu::Buffer& flux() const { return flux_; }
  /// W/m^2, two vec3 a cut cell: Gamma of the render query that sends out flux() besides.
  const gpu::Buffer& query_gamma() const { return query_gamma_; }
  /// W/m^2, two vec3 a cut cell: flux() and what of Gamma_s is left.
  const gpu::Buffer& entered() const { return entered_; }
  /// What shading/single.comp needs beside the picture's, the lights' and the ray tree's.
  gpu::Bindings picture_bindings() const;

 private:
  glm::vec3 measure_scale(const Lighting& lighting, const SceneMeshes& meshes) const;

  gpu::Context& context_;
  const Domain& domain_;
  const Diffusion& diffusion_;
  FacetReceivers receivers_;
  SingleFluxPush push_;
  gpu::Pass flux_pass_, leaves_pass_, scale_pass_, take_pass_, spread_pass_;
  gpu::Sampler linear_;
  glm::vec3 scale_{1};
  gpu::Buffer shares_, grid_, flux_, query_gamma_, entered_;
  gpu::Image images_[2];
};

}  // namespace alabaster
