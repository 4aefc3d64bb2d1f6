#include "lighting/exchange.h"

#include <algorithm>

#include "scene/error.h"
#include "shared/optics.h"

namespace alabaster {

static_assert(sizeof(ExchangeSide) == 8 && sizeof(LinkPush) == 48 && sizeof(ExchangePush) == 36);

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

struct OpaqueLightPush {
  std::uint32_t first, count;
};

}  // namespace

Exchange::Exchange(gpu::Context& context, const Scene& scene, const Lighting& lighting,
                   std::vector<ExchangeBody> bodies, const Settings& settings)
    : context_(context),
      directions_(settings.directions),
      environment_(lighting.samples().environment),
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
  find_links(scene, lighting);

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
  return push;
}

void Exchange::find_links(const Scene& scene, const Lighting& lighting) {
  const std::size_t objects = scene.objects.size();
  const gpu::Bindings tree = lighting.meshes().rays.bindings();
  std::vector<gpu::Buffer> hits(bodies_.size());
  gpu::Buffer counts(context_, (objects + 2) * sizeof(std::uint32_t), "link counts", gpu::Memory::host);
  const std::uint32_t* met = static_cast<const std::uint32_t*>(counts.mapped());
  gpu::Buffer lost(context_, sizeof(std::uint32_t), "lost links", gpu::Memory::host);
  gpu::Buffer slots(context_, sizeof(std::uint32_t), "opaque links", gpu::Memory::host);
  {
    gpu::Commands commands(context_);
    for (const gpu::Buffer* buffer : {&counts, &lost, &slots}) commands.fill(*buffer);
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      Part& part = bodies_[i];
      hits[i] = gpu::Buffer(context_, part.links.bytes() * 2, "link hits");
      gpu::Bindings bindings = tree;
      for (const gpu::Binding& b : gpu::Bindings{{"sides", part.side_buffer},
                                                 {"receivers", part.body.source.receivers()},
                                                 {"hits", hits[i]},
                                                 {"links", part.links},
                                                 {"counts", counts}})
        bindings.push_back(b);
      const LinkPush push = link_push(part);
      counts_.rays += std::uint64_t(push.sides) * push.directions;
      const auto timer = commands.time("links");
      commands.dispatch(links_pass_, {push.sides, push.directions, 1}, bindings, push);
    }
    commands.submit();
  }

  // Opaque places are emitters behind the facets.
  std::uint32_t places = 0;
  for (std::size_t i = 0; i < objects; ++i) {
    if (scene.objects[i].role == Role::translucent) counts_.translucent += met[i];
    if (scene.objects[i].role != Role::opaque || scene.objects[i].albedo == glm::vec3(0)) continue;
    places += met[i];
    counts_.opaque += met[i];
  }
  if (std::uint64_t(entries_) + places > link_emitters)
    throw UserError(scene.path + ": light between surfaces has more than " + std::to_string(link_emitters) +
                    " emitters; choose a coarser --grid or --interreflections 0");
  transmitted_ = gpu::Buffer(context_, (std::size_t(entries_) + places) * sizeof(glm::vec3), "radiance sent");
  known_transmitted_ = gpu::Buffer(context_, transmitted_.bytes(), "radiance known");
  const gpu::Buffer receivers(context_, std::max(places, 1u) * sizeof(Receiver), "opaque places");
  const gpu::Buffer irradiance(context_, std::max(places, 1u) * sizeof(glm::vec3), "irradiance of opaque places");

  gpu::Commands commands(context_);
  commands.fill(transmitted_);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    const auto timer = commands.time("links");
    LinkPush push = link_push(bodies_[i]);
    gpu::Bindings shared = tree;
    for (const gpu::Binding& b : gpu::Bindings{{"sides", bodies_[i].side_buffer},
                                               {"receivers", bodies_[i].body.source.receivers()},
                                               {"hits", hits[i]},
                                               {"links", bodies_[i].links}})
      shared.push_back(b);
    for (const Part& seen : bodies_) {
      if (!met[seen.body.object]) continue;
      push.first = seen.first;
      push.object = static_cast<std::uint32_t>(seen.body.object);
      push.eta = static_cast<float>(seen.body.eta);
      push.origin = seen.body.domain.frame.origin;
      push.h = seen.body.domain.frame.h;
      gpu::Bindings bindings = shared;
      bindings.push_back({"cut_index", seen.body.domain.cut_index});
      bindings.push_back({"cut_cells", seen.body.domain.cut_cells});
      bindings.push_back({"lost", lost});
      commands.dispatch(facets_pass_, {push.sides, push.directions, 1}, bindings, push);
    }
    if (!places) continue;
    gpu::Bindings bindings = shared;
    bindings.push_back({"count", slots});
    bindings.push_back({"places", receivers});
    bindings.push_back({"transmitted", transmitted_});
    for (std::size_t o = 0; o < objects; ++o) {
      if (!met[o] || scene.objects[o].role != Role::opaque || scene.objects[o].albedo == glm::vec3(0)) continue;
      push.object = static_cast<std::uint32_t>(o);
      push.first = entries_;
      push.albedo = scene.objects[o].albedo;
      commands.dispatch(opaque_pass_, {push.sides, push.directions, 1}, bindings, push);
    }
  }
  if (places) {
    lighting.record_gather(commands, receivers, places, 1, irradiance);
    commands.dispatch(opaque_light_pass_, {places, 1, 1}, {{"irradiance", irradiance}, {"transmitted", transmitted_}},
                      OpaqueLightPush{entries_, places});
  }
  commands.submit();
  counts_.lost = *static_cast<const std::uint32_t*>(lost.mapped());
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
