#include "lighting/exchange.h"

#include <algorithm>
#include <numeric>

#include "scene/error.h"
#include "shared/optics.h"

namespace alabaster {

static_assert(sizeof(ExchangeSide) == 8 && sizeof(LinkPush) == 56 && sizeof(ExchangePush) == 36);

namespace {

std::vector<ExchangeSide> sides_with_area(gpu::Context& context, const Domain& domain) {
  const std::vector<GpuCutCell> cuts = gpu::download<GpuCutCell>(context, domain.cut_cells);
  std::vector<ExchangeSide> sides;
  for (std::uint32_t i = 1; i <= domain.summary.cut_cells; ++i)
    for (std::uint32_t s = 0; s < 2; ++s) {
      const GpuFacet& facet = cuts[i].side[s];
      if (facet.area > 0 && glm::length(facet.area_vector) > 0)
        sides.push_back({2 * i + s, facet.area * domain.frame.h * domain.frame.h});
    }
  return sides;
}

std::vector<std::uint32_t> side_of_entries(const std::vector<ExchangeSide>& sides, std::size_t entries) {
  std::vector<std::uint32_t> side_of(entries, sky_no_side);
  for (std::size_t i = 0; i < sides.size(); ++i) side_of[sides[i].entry] = static_cast<std::uint32_t>(i);
  return side_of;
}

constexpr std::uint32_t least_asked = 8;  // light samples that an opaque place asks

bool reflects(const Object& object) { return object.role == Role::opaque && object.albedo != glm::vec3(0); }

struct OpaqueLightPush {
  std::uint32_t first, count;
};

}  // namespace

Exchange::Exchange(gpu::Context& context, const Scene& scene, const Lighting& lighting,
                   std::vector<ExchangeBody> bodies, const Settings& settings)
    : context_(context),
      directions_(settings.directions),
      shares_(
          std::clamp(static_cast<std::uint32_t>(lighting.samples().area.size()) / least_asked, 1u, most_light_shares)),
      environment_(lighting.samples().environment),
      order_passes_{{context, "lighting/link_order.comp", {0}}, {context, "lighting/link_order.comp", {1}}},
      links_pass_(context, "lighting/links.comp"),
      facets_pass_(context, "lighting/link_facets.comp"),
      opaque_pass_(context, "lighting/link_opaque.comp"),
      opaque_light_pass_(context, "lighting/opaque_light.comp"),
      gather_pass_(context, "lighting/exchange.comp") {
  if (directions_ < 4 || directions_ > 1024)
    throw UserError("light between surfaces: " + std::to_string(directions_) + " directions; choose 4 to 1024");
  std::size_t most_sides = 1;
  for (const ExchangeBody& body : bodies) {
    Part& part = bodies_.emplace_back(Part{body, sides_with_area(context, body.domain), entries_});
    entries_ += 2 * (body.domain.summary.cut_cells + 1);
    most_sides = std::max(most_sides, part.sides.size());
  }
  directions_ = static_cast<int>(
      std::clamp<std::size_t>(settings.memory / (most_sides * sizeof(RayHit)), 4, std::size_t(directions_)));
  for (Part& part : bodies_) {
    const std::size_t count = std::max<std::size_t>(part.sides.size(), 1);
    part.side_buffer = gpu::Buffer(context, count * sizeof(ExchangeSide), "exchange sides");
    if (!part.sides.empty()) gpu::upload(context, part.side_buffer, part.sides);
    part.side_of = gpu::make_buffer(context, side_of_entries(part.sides, part.body.source.count()), "sides of entries");
    part.links = gpu::Buffer(context, count * directions_ * sizeof(std::uint32_t), "links");
    part.irradiance = gpu::Buffer(context, 2 * std::size_t(part.body.domain.summary.cut_cells + 1) * sizeof(glm::vec3),
                                  "facet irradiance");
  }
  for (gpu::Buffer* mirrored : {&mirrored_[0], &mirrored_[1], &known_mirrored_})
    *mirrored = gpu::Buffer(context, entries_ * sizeof(glm::vec3), "mirrored");
  const Hits hits = trace(scene, lighting);
  link_facets(hits);
  link_opaque(scene, lighting, hits);

  gpu::Commands commands(context);
  for (const gpu::Buffer* buffer : {&mirrored_[0], &mirrored_[1], &known_transmitted_, &known_mirrored_})
    commands.fill(*buffer);
  for (const Part& part : bodies_)  // what of the lamps' light is mirrored is what they send less what enters
    lighting.record_gather(commands, part.body.source.receivers(), part.body.source.count(), 1, part.irradiance, false);
  commands.submit();
}

LinkPush Exchange::link_push(const Part& part) const {
  LinkPush push{};
  push.sides = static_cast<std::uint32_t>(part.sides.size());
  push.directions = static_cast<std::uint32_t>(directions_);
  push.shares = shares_;
  return push;
}

gpu::Bindings Exchange::bindings(const Hits& hits, std::size_t body) const {
  gpu::Bindings bindings = hits.tree;
  for (const gpu::Binding& b : gpu::Bindings{{"sides", bodies_[body].side_buffer},
                                             {"receivers", bodies_[body].body.source.receivers()},
                                             {"hits", hits.of_bodies[body]},
                                             {"links", bodies_[body].links}})
    bindings.push_back(b);
  return bindings;
}

Exchange::Hits Exchange::trace(const Scene& scene, const Lighting& lighting) {
  Hits hits{lighting.meshes().rays.bindings(), {}, {}};
  const gpu::Buffer counts(context_, scene.objects.size() * shares_ * sizeof(std::uint32_t), "link counts");
  gpu::Commands commands(context_);
  commands.fill(counts);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    hits.of_bodies.emplace_back(context_, bodies_[i].links.bytes() / sizeof(std::uint32_t) * sizeof(RayHit), "hits");
    gpu::Bindings all = bindings(hits, i);
    all.push_back({"counts", counts});
    const LinkPush push = link_push(bodies_[i]);
    counts_.rays += std::uint64_t(push.sides) * push.directions;
    const auto timer = commands.time("links");
    const gpu::Buffer &bins = commands.keep(gpu::Buffer(context_, 2 * link_bins * sizeof(std::uint32_t), "link bins")),
                      &order = commands.keep(gpu::Buffer(context_, bodies_[i].links.bytes(), "order of links"));
    commands.fill(bins);
    const glm::uvec3 rays(push.sides, push.directions, 1);
    for (const gpu::Pass& pass : order_passes_)
      commands.dispatch(pass, rays,
                        {{"sides", bodies_[i].side_buffer},
                         {"receivers", bodies_[i].body.source.receivers()},
                         {"bins", bins},
                         {"order", order}},
                        push);
    all.push_back({"order", order});
    commands.dispatch(links_pass_, rays, all, push);
  }
  commands.submit();
  hits.on = gpu::download<std::uint32_t>(context_, counts);
  return hits;
}

std::uint32_t Exchange::met(const Hits& hits, std::size_t object) const {
  const auto first = hits.on.begin() + static_cast<std::ptrdiff_t>(object * shares_);
  return std::accumulate(first, first + shares_, 0u);
}

void Exchange::link_facets(const Hits& hits) {
  const gpu::Buffer lost(context_, sizeof(std::uint32_t), "lost links");
  gpu::Commands commands(context_);
  commands.fill(lost);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const auto timer = commands.time("links");
    for (const Part& seen : bodies_) {
      const std::uint32_t count = met(hits, static_cast<std::size_t>(seen.body.object));
      if (!count) continue;
      LinkPush push = link_push(bodies_[i]);
      push.first = seen.first;
      push.object = static_cast<std::uint32_t>(seen.body.object);
      push.eta = static_cast<float>(seen.body.eta);
      push.origin = seen.body.domain.frame.origin;
      push.h = seen.body.domain.frame.h;
      gpu::Bindings all = bindings(hits, i);
      all.push_back({"cut_index", seen.body.domain.cut_index});
      all.push_back({"cut_cells", seen.body.domain.cut_cells});
      all.push_back({"lost", lost});
      commands.dispatch(facets_pass_, {push.sides, push.directions, 1}, all, push);
    }
  }
  commands.submit();
  for (const Part& seen : bodies_) counts_.translucent += met(hits, static_cast<std::size_t>(seen.body.object));
  counts_.lost = gpu::download<std::uint32_t>(context_, lost)[0];
}

/// Opaque places are emitters behind the facets, those of one share of the lights after those of another.
void Exchange::link_opaque(const Scene& scene, const Lighting& lighting, const Hits& hits) {
  std::vector<std::uint32_t> places_of(shares_);
  for (std::size_t o = 0; o < scene.objects.size(); ++o)
    for (std::uint32_t share = 0; share < shares_; ++share)
      if (reflects(scene.objects[o])) places_of[share] += hits.on[o * shares_ + share];
  const std::uint32_t places = std::accumulate(places_of.begin(), places_of.end(), 0u);
  counts_.opaque = places;
  if (std::uint64_t(entries_) + places > link_emitters)
    throw UserError(scene.path + ": light between surfaces has more than " + std::to_string(link_emitters) +
                    " emitters; choose a coarser --grid or --interreflections 0");
  transmitted_ = gpu::Buffer(context_, (std::size_t(entries_) + places) * sizeof(glm::vec3), "radiance sent");
  known_transmitted_ = gpu::Buffer(context_, transmitted_.bytes(), "radiance known");
  gpu::Commands commands(context_);
  commands.fill(transmitted_);
  if (!places) return commands.submit();

  const gpu::Buffer receivers(context_, places * sizeof(Receiver), "opaque places");
  const gpu::Buffer irradiance(context_, places * sizeof(glm::vec3), "irradiance of opaque places");
  const gpu::Buffer& slots = commands.keep(gpu::Buffer(context_, sizeof(std::uint32_t), "opaque links"));
  commands.fill(slots);
  for (std::uint32_t share = 0; share < shares_; ++share)
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const auto timer = commands.time("links");
      gpu::Bindings all = bindings(hits, i);
      all.push_back({"count", slots});
      all.push_back({"places", receivers});
      all.push_back({"transmitted", transmitted_});
      LinkPush push = link_push(bodies_[i]);
      push.first = entries_;
      push.share = share;
      for (std::size_t o = 0; o < scene.objects.size(); ++o) {
        if (!met(hits, o) || !reflects(scene.objects[o])) continue;
        push.object = static_cast<std::uint32_t>(o);
        push.albedo = scene.objects[o].albedo;
        commands.dispatch(opaque_pass_, {push.sides, (push.directions + shares_ - 1) / shares_, 1}, all, push);
      }
    }
  lighting.record_shared_gather(commands, receivers, places_of, irradiance);
  commands.dispatch(opaque_light_pass_, {places, 1, 1}, {{"irradiance", irradiance}, {"transmitted", transmitted_}},
                    OpaqueLightPush{entries_, places});
  commands.submit();
}

void Exchange::record_gather(gpu::Commands& commands, std::size_t body) {
  const Part& part = bodies_[body];
  const auto timer = commands.time("exchange");
  const ExchangePush push{static_cast<std::uint32_t>(part.sides.size()),
                          static_cast<std::uint32_t>(directions_),
                          part.first,
                          static_cast<float>(part.body.eta),
                          static_cast<float>(diffuse_reflectance(part.body.eta)),
                          environment_,
                          !part.body.lights_apart};
  commands.dispatch(gather_pass_, {push.sides, 1, 1},
                    {{"sides", part.side_buffer},
                     {"links", part.links},
                     {"transmitted", transmitted_},
                     {"mirrored", mirrored_[newest_]},
                     {"direct", part.body.source.direct()},
                     {"irradiance", part.irradiance},
                     {"flux", part.body.source.flux()},
                     {"known_transmitted", known_transmitted_},
                     {"known_mirrored", known_mirrored_},
                     {"mirrored_next", mirrored_[newest_ ^ 1]}},
                    push);
}

void Exchange::record_known(gpu::Commands& commands) {
  commands.copy(transmitted_, known_transmitted_, transmitted_.bytes());
  commands.copy(mirrored_[newest_], known_mirrored_, known_mirrored_.bytes());
  known_ = true;
}

Surroundings Exchange::around(std::size_t body) const {
  const Part& part = bodies_[body];
  const bool dark = environment_ == glm::vec3(0) && !known_;
  return {&part.links,
          &part.side_of,
          &known_transmitted_,
          &known_mirrored_,
          {static_cast<std::uint32_t>(part.sides.size()), dark ? 0 : static_cast<std::uint32_t>(directions_)}};
}

glm::dvec3 Exchange::total(std::size_t body, const gpu::Buffer& values) const {
  const std::vector<glm::vec3> all = gpu::download<glm::vec3>(context_, values);
  glm::dvec3 sum(0);
  for (const ExchangeSide& side : bodies_[body].sides) sum += double(side.area) * glm::dvec3(all[side.entry]);
  return sum;
}

}  // namespace alabaster
