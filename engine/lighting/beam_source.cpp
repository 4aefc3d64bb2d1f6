#include "lighting/beam_source.h"

#include <algorithm>

#include "lighting/beam_groups.h"

namespace alabaster {

static_assert(sizeof(BeamPush) == 116);

namespace {

std::uint32_t beams_at_once(glm::ivec3 cells) {
  const int turns = BEAM_MOST_STEPS * BEAM_TURNS_A_STEP * (cells.x + cells.y + cells.z);
  return static_cast<std::uint32_t>(std::max(BEAM_MOST_TURNS / turns, 1));
}

/// `count` samples from `first` on, `group` of them a beam.
struct Part {
  std::uint32_t first, count, group;
};

/// Lamps as their groups say, and then `sky` more.
std::vector<Part> parts_of(const std::vector<std::uint32_t>& groups, std::uint32_t sky, bool more,
                           std::uint32_t beams) {
  std::vector<Part> parts;
  std::uint32_t at = 0;
  for (std::uint32_t group : groups) {
    const bool joins = !parts.empty() && parts.back().group == group && parts.back().count < beams * group;
    if (joins)
      parts.back().count += group;
    else
      parts.push_back({at, group, group});
    at += group;
  }
  if (more) parts.clear();
  const std::uint32_t group = more ? BEAM_SURFACE_GROUP : 1, end = at + sky;
  for (; at < end; at += beams * group) parts.push_back({at, std::min(beams * group, end - at), group});
  return parts;
}

/// By round, the entries that have so many starts and one more; one round after the other.
std::vector<std::uint32_t> sides_of_rounds(const BeamStarts& starts, std::vector<std::uint32_t>& first_of) {
  std::vector<std::uint32_t> sides;
  for (std::uint32_t round = 0; round <= starts.most; ++round) {
    first_of.push_back(static_cast<std::uint32_t>(sides.size()));
    for (std::uint32_t entry = 0; entry < starts.of.size(); ++entry)
      if (starts.of[entry].y > round) sides.push_back(entry);
  }
  return sides;
}

}  // namespace

glm::dvec3 beam_unit(const LightSamples& lights, const GridFrame& frame) {
  const double h = frame.h;
  const glm::dvec3 low = frame.origin, high = low + h * glm::dvec3(frame.cells);
  glm::dvec3 most = M_PI * glm::dvec3(lights.environment);  // W/m^2 from one beam
  std::size_t i = 0;
  for (std::uint32_t group : beam_groups(lights, frame)) {
    glm::dvec3 sum(0);
    for (const std::size_t end = i + group; i < end; ++i) {
      const LightSample& light = lights.area[i];
      const glm::dvec3 at = light.position;
      const double distance = glm::length(glm::max(glm::max(low - at, at - high), glm::dvec3(0)));
      const double distance2 = light.kind == light_directional ? 1 : std::max(distance * distance, h * h);
      sum += glm::dvec3(light.intensity) / distance2;
    }
    most = glm::max(most, sum);
  }
  return most * (4 * h * h / BEAM_MOST_UNITS);  // a facet is seldom larger than 2 h^2
}

BeamSource::BeamSource(gpu::Context& context, const Domain& domain, const BeamStarts& starts, int channels, float skin)
    : domain_(domain),
      channels_(channels),
      skin_(skin),
      receivers_(context, domain),
      march_(context, "lighting/beam_march.comp"),
      source_(context, "lighting/beam_source.comp"),
      share_(context, "lighting/beam_through.comp", {0}),
      spread_(context, "lighting/beam_through.comp", {1}),
      counters_(context, 2 * 3 * BEAM_COUNTERS * sizeof(std::uint32_t), "beam counters", gpu::Memory::host),
      starts_(gpu::make_buffer(context, starts.starts, "beam starts")),
      starts_of_(gpu::make_buffer(context, starts.of, "beam starts of facets")),
      sides_(gpu::make_buffer(context, sides_of_rounds(starts, first_of_round_), "beam sides")),
      leaving_(context, 2 * 3 * receivers_.count() * sizeof(std::uint32_t), "beams that leave"),
      gamma_s_(context, receivers_.count() * sizeof(glm::vec3), "beam Gamma_f"),
      query_gamma_(context, receivers_.count() * sizeof(glm::vec3), "beam query Gamma"),
      entered_(context, receivers_.count() * sizeof(glm::vec3), "beam entered flux"),
      near_(context, receivers_.count() * sizeof(glm::vec4), "beam near light"),
      near_unscattered_(context, receivers_.count() * sizeof(glm::vec4), "beam near light of lamps"),
      shares_(context, receivers_.count() * sizeof(glm::vec3), "beam through, shares"),
      through_(context, receivers_.count() * sizeof(glm::vec3), "beam through") {
  const glm::ivec3 n = domain.frame.cells;
  const std::size_t words = std::size_t(n.x) * n.y * n.z * channels;
  deposits_ = gpu::Buffer(context, BEAM_LAYERS * words * sizeof(std::uint32_t), "beam deposits");
  carries_ = gpu::Buffer(context, BEAM_LAYERS * words * sizeof(std::uint32_t), "beam carries");
  power_ = gpu::image3d(context, {n.x / 4, n.y, n.z * channels}, VK_FORMAT_R32G32B32A32_SFLOAT, "beam power");
  seen_ = gpu::image3d(context, {n.x / 4, n.y, n.z * channels}, VK_FORMAT_R32G32B32A32_SFLOAT, "beam power seen");
  unscattered_ = gpu::image3d(context, {n.x / 4, n.y, n.z * channels}, VK_FORMAT_R8G8B8A8_UNORM, "beam power of lamps");
}

void BeamSource::record(gpu::Commands& commands, const Lighting& lighting, const BeamMedium& medium, double eta,
                        const Surroundings& around, bool more) {
  receivers_.record(commands);
  const auto timer = commands.time("beams");
  const SurfaceOptics optics(eta);
  const glm::ivec3 n = domain_.frame.cells;
  unit_ = beam_unit(lighting.samples(), domain_.frame);
  BeamPush push{domain_.frame.origin,
                n,
                static_cast<int>(receivers_.count() / 2),
                channels_,
                static_cast<float>(eta),
                static_cast<float>(optics.f_dt_outer),
                static_cast<float>(optics.A),
                static_cast<float>(optics.f_dt),
                domain_.frame.h,
                skin_,
                glm::vec3(medium.kappa_scale),
                glm::vec3(unit_),
                around.shape,
                0,
                0,
                0,
                0,
                0,
                0};
  push.sky.only_known = more;
  for (const gpu::Buffer* sums :
       {&deposits_, &carries_, &counters_, &leaving_, &gamma_s_, &query_gamma_, &entered_, &near_})
    if (!more) commands.fill(*sums);
  gpu::Bindings bindings = arrival_bindings(lighting, receivers_, around);
  for (const gpu::Binding& binding : gpu::Bindings{{"media", medium.facets},
                                                   {"cut_index", domain_.cut_index},
                                                   {"cut_cells", domain_.cut_cells},
                                                   {"volume", domain_.volume},
                                                   {"kappa", medium.kappa},
                                                   {"absorption", medium.absorption},
                                                   {"deposits", deposits_},
                                                   {"carries", carries_},
                                                   {"counters", counters_},
                                                   {"leaving", leaving_},
                                                   {"gamma_s", gamma_s_},
                                                   {"query_gamma", query_gamma_},
                                                   {"entered", entered_},
                                                   {"near_light", near_},
                                                   {"starts", starts_},
                                                   {"starts_of", starts_of_},
                                                   {"sides", sides_}})
    bindings.push_back(binding);
  const LightSamples& lights = lighting.samples();
  const std::uint32_t sky =
      around.shape.sides > 0 ? around.shape.directions : static_cast<std::uint32_t>(lights.directions.size());
  const std::vector<Part> parts = parts_of(beam_groups(lights, domain_.frame), sky, more, beams_at_once(n));
  for (push.round = 0; push.round + 1 < first_of_round_.size(); ++push.round) {
    push.listed_first = first_of_round_[push.round];
    push.listed = first_of_round_[push.round + 1] - push.listed_first;
    for (const Part& part : parts) {
      push.first = part.first;
      push.end = part.first + part.count;
      push.group = part.group;
      commands.dispatch(march_, {push.listed, 1, 1}, bindings, push);
    }
  }
  commands.dispatch(source_, {n.x / 4, n.y, n.z * channels_},
                    {{"deposits", deposits_},
                     {"carries", carries_},
                     {"power", power_},
                     {"seen", seen_},
                     {"unscattered", unscattered_}},
                    push);
  if (!more) commands.copy(near_, near_unscattered_, near_.bytes());
  const gpu::Bindings through{{"leaving", leaving_},
                              {"cut_cells", domain_.cut_cells},
                              {"cut_index", domain_.cut_index},
                              {"shares", shares_},
                              {"through", through_}};
  for (const gpu::Pass* pass : {&share_, &spread_}) commands.dispatch(*pass, {receivers_.count(), 1, 1}, through, push);
}

BeamTotals BeamSource::totals() const {
  const std::uint32_t* words = static_cast<const std::uint32_t*>(counters_.mapped());
  const auto sum = [&](int counter) {
    glm::dvec3 watts(0);
    for (int c = 0; c < 3; ++c) {
      const int k = 3 * counter + std::min(c, channels_ - 1);
      watts[c] = unit_[c] * (words[k] + 4294967296.0 * words[3 * BEAM_COUNTERS + k]);
    }
    return watts;
  };
  return {sum(BEAM_ENTERED), sum(BEAM_NEAR), sum(BEAM_IN_CELLS), sum(BEAM_ABSORBED), sum(BEAM_THROUGH)};
}

}  // namespace alabaster
