// The light near a facet as a view ray sees it (shared/gather.h), against integrals by the midpoint rule.
#include <gtest/gtest.h>

#include "shared/gather.h"

namespace alabaster {
namespace {

constexpr int steps = 20000;

/// Integral over depths 0 to `end` of what is scattered there by `density`, seen from the facet or from the far end.
template <class Density>
double seen(const NearLight& n, double end, bool behind, Density density) {
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double z = (i + 0.5) / steps * end, along = z / n.view;
    sum += density(z) * std::exp(-(behind ? n.tau - along : along)) / n.view * end / steps;
  }
  return sum;
}

TEST(NearLight, IsTheIntegralAlongTheRay) {
  for (float cosine : {0.3f, 0.8f, 1.0f})
    for (float view : {0.05f, 0.8f, 1.0f})
      for (float bound : {0.01f, 0.6f, 5.0f})
        for (float tau : {0.02f, 1.0f, 12.0f}) {
          const float skin = 0.4f * bound;
          const NearLight n{2, cosine, skin, bound, 0.9f, view, tau};
          const double end = std::min<double>(skin, double(tau) * view), whole = double(tau) * view,
                       m = near_mean_depth<double>(cosine, bound);
          const auto scattered = [&](double depth) { return 1 - std::exp(-depth / cosine); };
          const auto once = [&](double z) { return 2 * std::exp(-z / cosine) / (cosine * scattered(skin)); };
          const double driving = 2 * scattered(bound) / scattered(skin);
          const auto surplus = [&](double z) { return driving * 3 * 0.9 * m * std::exp(-z / m); };
          const auto expect = [&](float found, double exact) {
            EXPECT_NEAR(found, exact, 1e-3 * exact + 1e-6)
                << "cosine " << cosine << " view " << view << " bound " << bound << " tau " << tau;
          };
          expect(near_single(n), seen(n, end, false, once));
          expect(near_single_behind(n), seen(n, end, true, once));
          expect(near_surplus(n), seen(n, whole, false, surplus));
          expect(near_surplus_behind(n), seen(n, whole, true, surplus));
        }
}

// In a half space, lit by all of a beam: 1 / (mu + mu_view) and 3 a' mu^2 / (mu + mu_view).
TEST(NearLight, InAHalfSpaceIsTheClosedForm) {
  const NearLight n{1, 0.7f, 60, 60, 0.95f, 0.6f, 1e3f};
  EXPECT_NEAR(near_single(n), 1 / 1.3, 1e-5);
  EXPECT_NEAR(near_surplus(n), 3 * 0.95 * 0.49 / 1.3, 1e-4);
  EXPECT_EQ(near_single_behind(n), 0);
}

}  // namespace
}  // namespace alabaster
