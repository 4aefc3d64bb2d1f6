// Light that leaves one surface and enters another: between the parts of a concave object, between objects, and from
// opaque surfaces that lamps or the environment light (one reflection). Each side of each cut cell looks along a fixed
// set of directions; what it sees there (a link) is found once a geometry. Then, as often as the fluence changes, the
// facets' radiance is gathered along the links. The same directions decide how much of the environment is seen, so that
// in uniform light what is blocked and what comes instead add up exactly.
#pragma once

#include <vector>

#include "lighting/directional_source.h"
#include "lighting/facet_source.h"
#include "shared/exchange.h"

namespace alabaster {

/// A translucent object that takes part. The references outlive the exchange.
struct ExchangeBody {
  int object = 0;  // index in Scene::objects
  const Domain& domain;
  const FacetSource& source;
  double eta = 1;
  // The lamps' and the open environment's light enters by the source of the object's transport, and so does what
  // surfaces had sent at the last record_known(): flux() gets only what they send since. All is mirrored as ever.
  bool lights_apart = false;
};

class Exchange {
 public:
  struct Settings {
    int directions = 32;               // of each side of a cut cell, over its hemisphere
    std::uint32_t memory = 96u << 20;  // bytes of a link buffer at most; fewer directions where they do not fit
  };
  /// `lighting` has its shadow maps drawn; the bodies' receivers have been recorded (FacetSource::record_direct).
  /// Throws UserError for settings out of range.
  Exchange(gpu::Context& context, const Scene& scene, const Lighting& lighting, std::vector<ExchangeBody> bodies,
           const Settings& settings);

  /// Of `body`, into its FacetSource::flux(): the lamps' share (record_direct) plus what arrives along the links and
  /// from the open environment (ExchangeBody::lights_apart leaves both out). Reads transmitted(), and what all bodies
  /// mirrored in the gathers of the pass before.
  void record_gather(gpu::Commands& commands, std::size_t body);
  /// After every body's record_gather(): what they mirror is seen by the next.
  void next_pass() { newest_ ^= 1; }

  /// Radiance that leaves over F_t, W/m^2/sr, vec3: entry first(body) + 2 * cut cell + side; opaque places behind. The
  /// caller writes its bodies' before a gather.
  const gpu::Buffer& transmitted() const { return transmitted_; }
  std::uint32_t first(std::size_t body) const { return bodies_[body].first; }

  /// W, per channel: sum over a body's sides of area times `values` (vec3 an entry, W/m^2).
  glm::dvec3 total(std::size_t body, const gpu::Buffer& values) const;

  /// Of all rays that were asked, those that met a translucent and an opaque object; and those that met a translucent
  /// one where no facet was found, which count as dark.
  struct Counts {
    std::uint64_t rays = 0, translucent = 0, opaque = 0, lost = 0;
  };
  const Counts& counts() const { return counts_; }
  int directions() const { return directions_; }
  /// What surfaces send now is known to the sources of the transports from here on (ExchangeBody::lights_apart).
  void record_known(gpu::Commands& commands);
  /// What the facets of `body` see, for the source of its transport: the environment and what is known of surfaces.
  Surroundings around(std::size_t body) const;
  const gpu::Buffer& links(std::size_t body) const { return bodies_[body].links; }
  const gpu::Buffer& sides(std::size_t body) const { return bodies_[body].side_buffer; }

 private:
  struct Part {
    ExchangeBody body;
    std::vector<ExchangeSide> sides;
    std::uint32_t first = 0;  // emitter of entry 0
    gpu::Buffer side_buffer, side_of, links, irradiance;
  };
  struct Hits {  // of the links' rays
    gpu::Bindings tree;
    std::vector<gpu::Buffer> of_bodies;  // RayHit [direction][side]
    std::vector<std::uint32_t> on;       // [object][share of the light samples]
  };
  Hits trace(const Scene& scene, const Lighting& lighting);
  std::uint32_t met(const Hits& hits, std::size_t object) const;
  void link_facets(const Hits& hits);
  void link_opaque(const Scene& scene, const Lighting& lighting, const Hits& hits);
  LinkPush link_push(const Part& part) const;
  gpu::Bindings bindings(const Hits& hits, std::size_t body) const;

  gpu::Context& context_;
  int directions_;
  std::uint32_t shares_;  // of the light samples: most_light_shares
  glm::vec3 environment_;
  std::uint32_t entries_ = 0;  // of all bodies
  gpu::Pass order_passes_[2], links_pass_, facets_pass_, opaque_pass_, opaque_light_pass_, gather_pass_;
  std::vector<Part> bodies_;
  gpu::Buffer transmitted_, mirrored_[2], known_transmitted_, known_mirrored_;
  bool known_ = false;  // there is any
  int newest_ = 0;      // of mirrored_
  Counts counts_;
};

}  // namespace alabaster
