#include "scene/procedural.h"

#include <algorithm>
#include <cmath>

#include "scene/presets.h"

namespace alabaster {
namespace {

static_assert(sizeof(ProceduralSolid) == 96);

SolidPart measured(const char* name) {
  const Coefficients found = preset(name)->coefficients;
  return {found.sigma_s, found.sigma_a};
}

/// Jensen's marble, and veins that scatter less and absorb 60 times as much, reddish.
void marble(SolidPart (&parts)[3]) {
  parts[0] = parts[1] = measured("marble");
  parts[1].sigma_s *= 0.6f;
  parts[1].sigma_a *= 60.f * glm::vec3(1, 1.15f, 1.3f);
}

// The rest are chosen by eye; skin's dermis is Jensen's skin2.
const SolidPart jade[] = {{{380, 520, 420}, {9, 1.2f, 6}}, {{300, 420, 330}, {40, 9, 28}}};
const SolidPart wax[] = {{{1100, 950, 700}, {1.5f, 6, 22}}, {{800, 640, 420}, {2.5f, 10, 40}}};
const SolidPart wood[] = {{{900, 750, 500}, {20, 60, 160}}, {{1400, 1000, 600}, {40, 130, 260}}};
const SolidPart agate[] = {{{150, 130, 110}, {2, 5, 9}}, {{1500, 1200, 900}, {3, 18, 40}}};
const SolidPart checker[] = {{{1000, 1000, 1000}, {1, 1, 1}}, {{600, 600, 600}, {30, 60, 90}}};
const SolidPart skin[] = {
    {{1100, 1600, 1800}, {60, 150, 300}}, {{1090, 1590, 1790}, {13, 70, 145}}, {{1200, 1300, 1400}, {3, 6, 12}}};

glm::vec3 coefficient(const Fields& part, const std::string& key) {
  const glm::dvec3 value = part.rgb(key);
  if (glm::any(glm::lessThan(value, glm::dvec3(0)))) part.fail(key, "must not be negative");
  return value;
}

SolidPart read_part(const Fields& part) {
  if (!part.has("preset")) return {coefficient(part, "sigma_s"), coefficient(part, "sigma_a")};
  const std::string name = part.text("preset");
  if (!preset(name)) part.fail("preset", "\"" + name + "\" is not a known preset; use one of: " + preset_names());
  return measured(name.c_str());
}

float positive(const Fields& from, const std::string& key, float usual) {
  const double value = from.number_or(key, usual);
  if (!(value > 0 && value < 1e6)) from.fail(key, "must be positive");
  return static_cast<float>(value);
}

std::uint32_t read_kind(const Fields& medium) {
  const std::string name = medium.text("name");
  std::string known;
  for (std::uint32_t kind = 0; kind < solid_kinds; ++kind) {
    if (name == solid_names[kind]) return kind;
    known += (known.empty() ? "" : ", ") + std::string(solid_names[kind]);
  }
  medium.fail("name", "\"" + name + "\" is not a known procedural solid; use one of: " + known);
}

}  // namespace

const char* const solid_names[solid_kinds] = {"marble", "jade", "wax", "wood", "agate", "checker", "skin"};

int parts_of(std::uint32_t kind) { return kind == solid_skin ? 3 : 2; }

double solid_feature(const ProceduralSolid& solid) {
  const double sharp = solid.sharpness;
  switch (solid.kind) {
    case solid_marble:  // exp(-60 sharpness wave^2), the wave of slope 11 and what bends it
      return 2 / (std::sqrt(60 * sharp) * (11 + 10 * solid.turbulence));
    case solid_agate:
      return 0.06 / std::max(1.0, sharp);
    case solid_wood:
      return 0.1 * std::min(0.5, 0.1 / sharp);
    case solid_checker:
      return 1;
    default:
      return 0.1 / std::max(1.0, sharp);
  }
}

ProceduralSolid usual_solid(std::uint32_t kind) {
  ProceduralSolid solid{};
  solid.kind = kind;
  solid.turbulence = solid.sharpness = 1;
  solid.depths = {2e-4f, 2e-3f};
  const SolidPart* const usual[solid_kinds] = {nullptr, jade, wax, wood, agate, checker, skin};
  if (kind == solid_marble)
    marble(solid.parts);
  else
    std::copy_n(usual[kind], parts_of(kind), solid.parts);
  if (parts_of(kind) == 2) solid.parts[2] = solid.parts[0];  // its share is 0
  return solid;
}

ProceduralSolid read_procedural(const Fields& medium) {
  ProceduralSolid solid = usual_solid(read_kind(medium));
  const double seed = medium.number_or("seed", 0);
  if (!(seed >= 0 && seed < 4294967296.0) || seed != std::floor(seed))
    medium.fail("seed", "must be a whole number from 0 to 4294967295");
  solid.seed = static_cast<std::uint32_t>(seed);
  const double turbulence = medium.number_or("turbulence", solid.turbulence);
  if (!(turbulence >= 0 && turbulence <= 100)) medium.fail("turbulence", "must lie in 0..100");
  solid.turbulence = static_cast<float>(turbulence);
  solid.sharpness = positive(medium, "sharpness", solid.sharpness);
  if (solid.kind == solid_skin && solid.sharpness < 0.25f)
    medium.fail("sharpness", "must be at least 0.25 for skin: its layers blend over 0.25 / sharpness of their depth");
  const int count = parts_of(solid.kind);
  if (medium.has("depths")) {
    const std::vector<double> depths = medium.numbers("depths", 2);
    if (!(depths[0] > 0 && depths[0] < depths[1]))
      medium.fail("depths", "must be two positive depths in metres, the smaller one first");
    solid.depths = {depths[0], depths[1]};
  }
  if (medium.has("parts")) {
    const std::vector<Fields> parts = medium.list("parts");
    if (int(parts.size()) != count)
      medium.fail("parts", "must be a list of " + std::to_string(count) + " for " + solid_names[solid.kind]);
    for (int i = 0; i < count; ++i) solid.parts[i] = read_part(parts[i]);
    if (count == 2) solid.parts[2] = solid.parts[0];
  }
  return solid;
}

}  // namespace alabaster
