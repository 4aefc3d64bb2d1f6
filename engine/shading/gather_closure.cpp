#include "shading/gather_closure.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "shared/gather.h"

namespace alabaster {
namespace {

/// The fluence of the diffusion equation in a half space.
struct HalfSpace {
  double albedo, A, q, s, r;

  HalfSpace(double a, double boundary)
      : albedo(a), A(boundary), q(std::sqrt(3 * std::max(1 - a, 1e-10))), s(2 * A * q / 3), r((s - 1) / (s + 1)) {}
  double C(double k) const { return albedo * k / (1 - albedo - k * k / 3); }
  double B(double k) const { return -C(k) * (1 + 2 * A * k / 3) / (1 + s); }
};

/// Moments of the reflectance from inside, R_n = integral of R(mu) mu^n dmu.
std::array<double, 7> reflected_moments(double eta) {
  constexpr int cosines = 4000;
  std::array<double, 7> moments{};
  for (int i = 0; i < cosines; ++i) {
    const double mu = (i + 0.5) / cosines;
    double part = fresnel_reflectance(mu, 1 / eta) / cosines;
    for (double& moment : moments) moment += part, part *= mu;
  }
  return moments;
}

double leak_of(double eta) {
  const std::array<double, 7> R = reflected_moments(eta);
  const double A2 = -9 * R[1] / 4 + 15 * R[3] / 2 - 25 * R[5] / 4, B2 = 63 * R[2] / 4 - 105 * R[4] / 2 + 175 * R[6] / 4;
  return 9.0 / 5 * (7.0 / 24 + A2) / (1 + B2);
}

}  // namespace

// Midpoint rule over the outside cosine c, from which mu dmu = c dc / eta^2.
GatherClosures::GatherClosures(double eta)
    : eta_(eta), A_(boundary_constant(internal_diffuse_reflectance<double>(eta))), leak_(leak_of(eta)) {
  constexpr int cosines = 200;
  for (int i = 0; i < cosines; ++i) {
    const double c = (i + 0.5) / cosines;
    const double share = c * fresnel_transmittance(c, eta) / cosines;
    if (share > 0) directions_.push_back({refracted_cosine(c, eta), share});  // below 1 steep light does not enter
  }
  std::vector<Sent> white;
  double shares = 0;
  for (const Direction& d : directions_) {
    white.push_back(sent(1, d.inside));
    shares += d.share;
  }
  // What is sent in each direction depends on the closure, and that on how much of it leaves: a few rounds settle it.
  for (int round = 0; round < 30; ++round) {
    white_ = closed(1, white);
    double mean = 0;
    for (std::size_t i = 0; i < white.size(); ++i) {
      directions_[i].exit = 1 / (white_.diffuse * white[i].diffused + white_.beams * white[i].once);
      mean += directions_[i].share * directions_[i].exit / shares;
    }
    for (Direction& d : directions_) d.exit /= mean;
    exit_scale_ = 1 / mean;
  }
}

GatherClosures::Sent GatherClosures::sent(double albedo, double view) const {
  const HalfSpace half(albedo, A_);
  Sent sum;
  sum.from_depth = albedo * (1 / (1 - half.q * view) + half.r / (1 + half.q * view));
  for (const Direction& in : directions_) {
    const double k = 1 / in.inside;
    sum.diffused += in.share * albedo * (half.B(k) / (1 + half.q * view) + half.C(k) / (1 + k * view));
    sum.once += in.share * albedo * k / (1 + k * view);
  }
  return sum;
}

GatherClosure GatherClosures::closed(double albedo, const std::vector<Sent>& sent) const {
  const HalfSpace half(albedo, A_);
  double wanted = 0, diffused = 0, once = 0, from_depth = 0;
  for (std::size_t i = 0; i < directions_.size(); ++i) {
    const Direction& d = directions_[i];
    const double k = 1 / d.inside, leaves = d.share * d.exit / (2 * eta_ * eta_);
    wanted += d.share * (half.B(k) + half.C(k)) / (2 * A_);
    diffused += leaves * sent[i].diffused;
    once += leaves * sent[i].once;
    from_depth += leaves * sent[i].from_depth;
  }
  GatherClosure closure;
  closure.diffuse = (1 + half.r) / (2 * A_) / from_depth;
  closure.beams = (wanted - closure.diffuse * diffused) / once;
  return closure;
}

GatherClosure GatherClosures::at(double albedo) const {
  std::vector<Sent> each;
  for (const Direction& d : directions_) each.push_back(sent(albedo, d.inside));
  return closed(albedo, each);
}

double GatherClosures::exit(double cosine) const {
  const Sent white = sent(1, std::max(refracted_cosine(cosine, eta_), 1e-3));
  return exit_scale_ / (white_.diffuse * white.diffused + white_.beams * white.once);
}

// Under e^(-k z) spread light is (e^(-k z) - (leak + k L^2) / (leak + L) e^(-z / L)) / (1 - k^2 L^2).
double GatherClosures::kept() const {
  constexpr double square = GATHER_SPREAD;
  const double length = std::sqrt(square);
  double spread = 0, beams = 0;
  for (const Direction& out : directions_)
    for (const Direction& in : directions_) {
      const double k = 1 / in.inside, weight = out.share * out.exit * in.share * k;
      double apart = 1 - k * k * square;
      if (std::abs(apart) < 1e-6) apart = 1e-6;  // the quotient has no pole there
      const double straight = 1 / (1 + k * out.inside), layer = 1 / (1 + out.inside / length);
      spread += weight * (straight - (leak_ + k * square) / (leak_ + length) * layer) / apart;
      beams += weight * straight;
    }
  return spread / beams;
}

std::vector<glm::vec2> GatherClosures::table() const {
  std::vector<glm::vec2> closures;
  for (int i = 0; i < GATHER_CLOSURES; ++i) {
    const double root = double(i) / (GATHER_CLOSURES - 1);
    const GatherClosure closure = at(1 - GATHER_MOST_ABSORBED * root * root);
    closures.emplace_back(closure.diffuse, closure.beams);
  }
  return closures;
}

std::vector<float> GatherClosures::exits() const {
  std::vector<float> exits;
  for (int i = 0; i < GATHER_EXITS; ++i) {
    const double root = double(i) / (GATHER_EXITS - 1);
    exits.push_back(static_cast<float>(exit(std::max(root * root, 1e-4))));
  }
  return exits;
}

}  // namespace alabaster
