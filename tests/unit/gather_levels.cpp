// The gather's levels (shading/gather_levels.h): what they keep, and how far they tell places apart.
#include "shading/gather_levels.h"

#include <gtest/gtest.h>

#include <cmath>

namespace alabaster {
namespace {

/// Places all over a ball, `wanted` of a flux that the gather takes to be 1.
template <class Wanted>
std::vector<GatherPlace> ball(glm::dvec3 middle, double radius, Wanted wanted) {
  std::vector<GatherPlace> places;
  constexpr int count = 2000;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, angle = i * M_PI * (3 - std::sqrt(5.0));
    const glm::dvec3 normal(std::sqrt(1 - z * z) * std::cos(angle), std::sqrt(1 - z * z) * std::sin(angle), z);
    places.push_back({middle + radius * normal, normal, {glm::vec3(wanted(normal)), glm::vec3(1)}});
  }
  return places;
}

TEST(GatherLevels, OneRatioIsOneLevel) {
  const glm::dvec3 ratio(0.5, 1, 2);
  const auto places = ball({20, 20, 20}, 15, [&](glm::dvec3) { return ratio; });
  const GatherLevels levels({40, 40, 40}, 6.5f, places);
  for (const GatherPlace& place : places)
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(levels.at(place.position, place.normal)[c], ratio[c], 1e-5);
}

// What leaves all told is the diffusion equation's, however unevenly.
TEST(GatherLevels, KeepTheFluxOfAllPlaces) {
  const auto places = ball({20, 24, 18}, 15, [](glm::dvec3 n) {
    return glm::dvec3(1 + 0.5 * n.x, 1 + 0.9 * std::sin(5 * n.y), n.z > 0.2 ? 1.3 : 0.7);
  });
  const GatherLevels levels({44, 48, 36}, 4, places);
  glm::dvec3 wanted(0), sent(0);
  for (const GatherPlace& place : places) {
    wanted += glm::dvec3(place.flux.wanted);
    sent += levels.at(place.position, place.normal) * glm::dvec3(place.flux.gathered);
  }
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sent[c] / wanted[c], 1, 1e-6);
}

// Two parts, ten nodes apart, keep their own levels, and so do the two sheets of a plate thinner than the nodes'
// distance.
TEST(GatherLevels, PartsAndSheetsHaveTheirOwn) {
  auto places = ball({12, 12, 12}, 8, [](glm::dvec3) { return glm::dvec3(0.8); });
  const auto others = ball({72, 12, 12}, 8, [](glm::dvec3) { return glm::dvec3(1.25); });
  places.insert(places.end(), others.begin(), others.end());
  const GatherLevels parts({84, 24, 24}, 5, places);
  for (const GatherPlace& place : places)
    ASSERT_NEAR(parts.at(place.position, place.normal).g, place.position.x < 42 ? 0.8 : 1.25, 0.01);

  std::vector<GatherPlace> plate;
  for (int i = 0; i < 400; ++i)
    for (int up = 0; up < 2; ++up)
      plate.push_back({glm::vec3(i % 20, i / 20, 9 + 2 * up),
                       glm::vec3(0, 0, up ? 1 : -1),
                       {glm::vec3(up ? 0.9f : 1.2f), glm::vec3(1)}});
  const GatherLevels sheets({20, 20, 20}, 5, plate);
  for (const GatherPlace& place : plate)
    ASSERT_NEAR(sheets.at(place.position, place.normal).g, place.normal.z > 0 ? 0.9 : 1.2, 0.01);
}

// Within the nodes' distance the gather says where light leaves: a chequerboard of squares a third as long is left as
// it is.
TEST(GatherLevels, LeaveFineDetailToTheGather) {
  std::vector<GatherPlace> plane;
  for (int i = 0; i < 60 * 60; ++i)
    plane.push_back({glm::vec3(i % 60, i / 60, 10),
                     glm::vec3(0, 0, 1),
                     {glm::vec3((i % 60 / 2 + i / 60 / 2) % 2 ? 1.4f : 0.6f), glm::vec3(1)}});
  const GatherLevels levels({60, 60, 20}, 6, plane);
  for (const GatherPlace& place : plane) {
    const glm::vec2 p(place.position);
    const bool rim = std::min(p.x, p.y) < 6 || std::max(p.x, p.y) >= 54;  // the nodes there see half as many squares
    ASSERT_NEAR(levels.at(place.position, place.normal).g, 1, rim ? 0.05 : 0.005);
  }
}

// Nothing is known of a dark object, and of its dark parts what the rest says.
TEST(GatherLevels, DarkPlacesTakeTheMean) {
  EXPECT_EQ(GatherLevels({8, 8, 8}, 4, {}).at({4, 4, 4}, {0, 0, 1}), glm::dvec3(1));
  auto places = ball({12, 12, 12}, 8, [](glm::dvec3) { return glm::dvec3(0.8); });
  places.push_back({glm::vec3(80, 12, 12), glm::vec3(1, 0, 0), {glm::vec3(0), glm::vec3(0)}});
  EXPECT_NEAR(GatherLevels({84, 24, 24}, 5, places).at({80, 12, 12}, {1, 0, 0}).r, 0.8, 1e-5);
}

}  // namespace
}  // namespace alabaster
