#include "pipeline/interreflections.h"

#include <algorithm>

namespace alabaster {
namespace {

// The passes end when the next one, settle()'s, will change what surfaces send each other by less than this share of
// the light.
constexpr double exchange_tolerance = 2e-5;
// The solver's residual in a pass, of the change in the pass before.
constexpr double residual_share = 0.05;

std::vector<ExchangeBody> exchange_bodies(const std::vector<LitBody>& bodies) {
  std::vector<ExchangeBody> result;
  for (const LitBody& body : bodies)
    result.push_back({body.object, body.domain, body.light.facets(), body.eta, body.light.apart()});
  return result;
}

// The transports' own sources bring in what surfaces send when that has come so near to its end.
constexpr double known_from = 1e-2;

}  // namespace

Interreflections::Interreflections(gpu::Context& context, const Scene& scene, const Lighting& lighting,
                                   const Plan& plan, std::vector<LitBody> bodies)
    : context_(context),
      lighting_(lighting),
      plan_(plan),
      bodies_(std::move(bodies)),
      exchange_(context, scene, lighting, exchange_bodies(bodies_), {plan.exchange_directions}) {
  report_.directions = exchange_.directions();
  report_.counts = exchange_.counts();
}

void Interreflections::light_apart(bool again) {
  gpu::Commands commands(context_);
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    bodies_[i].light.record_lights_apart(commands, lighting_, exchange_.around(i), again);
  commands.submit();
}

void Interreflections::start() {
  light_apart(false);
  gather();
  at_start_ = entered_ = entering();
  lights_ = glm::dvec3(0);
  for (const glm::dvec3& entered : entered_) lights_ += entered;
}

/// The transports' own sources bring in what surfaces send now; what changes from here on enters by the facets.
void Interreflections::learn() {
  gpu::Commands commands(context_);
  exchange_.record_known(commands);
  commands.submit();
  light_apart(true);
}

void Interreflections::gather() {
  gpu::Commands commands(context_);
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    exchange_.record_gather(commands, i);
    bodies_[i].light.record_surfaces(commands);
  }
  commands.submit();
  exchange_.next_pass();
}

void Interreflections::send() {
  gpu::Commands commands(context_);
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    bodies_[i].diffusion.record_exit(commands, bodies_[i].light.light(), 1 / (bodies_[i].eta * bodies_[i].eta),
                                     exchange_.transmitted(), exchange_.first(i));
  commands.submit();
}

glm::dvec3 Interreflections::by_facets(std::size_t body) const {
  return exchange_.total(body, bodies_[body].light.facets().gamma_s());
}

std::vector<glm::dvec3> Interreflections::entering() const {
  std::vector<glm::dvec3> total;
  for (std::size_t i = 0; i < bodies_.size(); ++i)
    total.push_back(by_facets(i) +
                    bodies_[i].light.own_power([&](const gpu::Buffer& values) { return exchange_.total(i, values); }));
  return total;
}

/// Returns the change, of what the lights alone send into all bodies together.
double Interreflections::adopt(std::vector<glm::dvec3> entered) {
  glm::dvec3 moved(0);
  for (std::size_t i = 0; i < bodies_.size(); ++i) moved += glm::abs(entered[i] - entered_[i]);
  entered_ = std::move(entered);
  double largest = 0;
  for (int c = 0; c < 3; ++c)
    if (lights_[c] > 0) largest = std::max(largest, moved[c] / lights_[c]);
  return largest;
}

void Interreflections::approach() {
  if (report_.counts.translucent == 0) return;
  double moved = 1, slowest = 0;
  bool apart = std::any_of(bodies_.begin(), bodies_.end(), [](const LitBody& body) { return body.light.apart(); });
  for (bool ended = false; report_.passes < plan_.interreflections && !ended; ++report_.passes) {
    for (const LitBody& body : bodies_)
      body.diffusion.approach(body.light.light(), std::max(plan_.tolerance, residual_share * moved));
    send();
    const bool learns = apart && moved < known_from;
    if (learns) learn();
    apart = apart && !learns;
    gather();
    const double before = moved;
    moved = adopt(entering());
    if (!learns) slowest = std::max(slowest, moved / before);
    // What changed last, and what the solver left, fall once more.
    ended = !learns && slowest * (moved + residual_share * before) < exchange_tolerance;
  }
}

void Interreflections::settle() {
  if (report_.counts.translucent == 0) return;
  send();
  gather();
  report_.under_way = adopt(entering());
}

}  // namespace alabaster
