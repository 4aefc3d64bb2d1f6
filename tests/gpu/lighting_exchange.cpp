// Links from the sides of cut cells to what they see, and the gather along them, against double-precision twins.
#include <numeric>
#include <random>

#include "domain/cut_cells.h"
#include "lighting/exchange.h"
#include "scene/shapes.h"
#include "support/lighting_twin.h"
#include "support/lit_scene.h"

namespace alabaster {
namespace {

/// One object of a lit scene, on a grid.
struct Gridded {
  Gridded(gpu::Context& c, const LitScene& lit, int object_index, int cells)
      : object(object_index),
        domain(make_domain(c, lit.scene.objects[object].mesh,
                           choose_frame(bounds_of(lit.scene.objects[object].mesh), cells))),
        source(c, domain),
        cuts(gpu::download<GpuCutCell>(c, domain.cut_cells)) {
    gpu::Commands commands(c);
    source.record_direct(commands, lit.lighting, lit.scene.objects[object].eta, false);
    commands.submit();
    receivers = gpu::download<Receiver>(c, source.receivers());
  }
  int object;
  Domain domain;
  FacetSource source;
  std::vector<GpuCutCell> cuts;
  std::vector<Receiver> receivers;
};

/// link_direction() of lighting/link.glsl.
glm::dvec3 direction(glm::dvec3 n, std::uint32_t entry, std::uint32_t k, std::uint32_t count) {
  std::uint32_t x = entry * 0x9e3779b9u;
  x = (x ^ (x >> 16)) * 0x85ebca6bu;
  x = (x ^ (x >> 13)) * 0xc2b2ae35u;
  const double turn = double((x ^ (x >> 16)) >> 8) / 16777216.0, c = std::sqrt(1 - (k + 0.5) / count),
               s = std::sqrt(1 - c * c), angle = 2 * M_PI * (k * 0.6180339887498949 + turn);
  const double sign = n.z >= 0 ? 1 : -1, a = -1 / (sign + n.z), b = n.x * n.y * a;
  const glm::dvec3 across(1 + sign * n.x * n.x * a, sign * b, -sign * n.x), up(b, sign + n.y * n.y * a, -n.y);
  return s * std::cos(angle) * across + s * std::sin(angle) * up + c * n;
}

/// bin_of() of lighting/link_order.comp.
std::uint32_t part_of_sphere(glm::dvec3 way) {
  int axis = 0;
  for (int a = 1; a < 3; ++a)
    if (std::abs(way[a]) > std::abs(way[axis])) axis = a;
  const glm::ivec2 part(
      glm::clamp(1.5 * glm::dvec2(way[(axis + 1) % 3], way[(axis + 2) % 3]) / std::abs(way[axis]) + 1.5, 0.0, 2.999));
  return 9 * (2 * axis + (way[axis] < 0)) + 3 * part.x + part.y;
}

class LightingExchange : public GpuTest {
 protected:
  /// A torus and a ball above it, a grey plate below, a lamp.
  static Scene scene() {
    Scene scene;
    Object plate = make_object(Role::opaque, transformed(quad(5, 5), translation({0, -0.8, 0})));
    plate.albedo = {0.5f, 0.4f, 0.3f};
    scene.objects = {
        make_object(Role::translucent, torus(1, 0.4f, 48, 24)), plate,
        make_object(Role::translucent, transformed(icosphere(3, 0.4f), translation({0.2, 0.8, 0.1}))),
        make_light(transformed(quad(0.6f, 0.6f), translation({0.5, 3, 0.2}) * rotation({1, 0, 0}, 180)), {3, 5, 7})};
    scene.objects[0].eta = 1.4;
    scene.objects[2].eta = 1.2;
    scene.environment.radiance = {0.2f, 0.1f, 0.3f};
    return scene;
  }
  static constexpr int directions = 24;

  const LitScene lit{context, scene(), {8, 16, 256}};
  Gridded torus_part{context, lit, 0, 24}, ball_part{context, lit, 2, 16};
  std::vector<ExchangeBody> bodies() const {
    return {{0, torus_part.domain, torus_part.source, 1.4}, {2, ball_part.domain, ball_part.source, 1.2}};
  }
};

TEST_F(LightingExchange, RaysAreListedOnceAndPartByPart) {
  std::vector<ExchangeSide> sides;
  for (std::uint32_t entry = 2; entry < torus_part.receivers.size(); ++entry)
    if (const float area = torus_part.cuts[entry / 2].side[entry % 2].area; area > 0) sides.push_back({entry, area});
  const std::size_t rays = directions * sides.size();
  const gpu::Buffer bins = gpu::make_buffer(context, std::vector<std::uint32_t>(2 * link_bins), "bins"),
                    order = gpu::make_buffer(context, std::vector<std::uint32_t>(rays, ~0u), "order"),
                    side_buffer = gpu::make_buffer(context, sides, "sides");
  LinkPush push{};
  push.sides = static_cast<std::uint32_t>(sides.size());
  push.directions = directions;
  gpu::Commands commands(context);
  const gpu::Pass counting(context, "lighting/link_order.comp", {0}), listing(context, "lighting/link_order.comp", {1});
  for (const gpu::Pass* pass : {&counting, &listing})
    commands.dispatch(
        *pass, {push.sides, directions, 1},
        {{"sides", side_buffer}, {"receivers", torus_part.source.receivers()}, {"bins", bins}, {"order", order}}, push);
  commands.submit();

  const auto part = [&](std::uint32_t ray) {
    const std::uint32_t entry = sides[ray / directions].entry;
    return part_of_sphere(direction(torus_part.receivers[entry].normal, entry, ray % directions, directions));
  };
  std::vector<std::uint32_t> listed = gpu::download<std::uint32_t>(context, order), end(link_bins + 1);
  listed.resize(rays);
  for (std::uint32_t ray = 0; ray < rays; ++ray) ++end[part(ray) + 1];
  std::partial_sum(end.begin(), end.end(), end.begin());
  int elsewhere = 0;  // rays so near an edge between parts that rounding takes them across shift the parts behind, too
  for (std::uint32_t i = 0; i < rays; ++i) {
    ASSERT_LT(listed[i], rays) << i;
    elsewhere += i + 8 < end[part(listed[i])] || i >= end[part(listed[i]) + 1] + 8;
  }
  EXPECT_LE(elsewhere, 8) << "of " << rays;
  std::sort(listed.begin(), listed.end());
  for (std::uint32_t i = 0; i < rays; ++i) ASSERT_EQ(listed[i], i);
  EXPECT_GT(rays, 20000u);
}

TEST_F(LightingExchange, LinksEqualTwin) {
  const Exchange exchange(context, lit.scene, lit.lighting, bodies(), {directions});
  EXPECT_EQ(exchange.counts().lost, 0u);
  EXPECT_GT(exchange.counts().translucent, 1000u);
  EXPECT_GT(exchange.counts().opaque, 1000u);
  const Gridded* parts[] = {&torus_part, &ball_part};
  const std::uint32_t places = exchange.first(1) + 2 * (ball_part.domain.summary.cut_cells + 1);
  int seen[4] = {0}, apart = 0, asked = 0;  // nothing, opaque, translucent, lamp
  for (std::size_t body = 0; body < 2; ++body) {
    const auto links = gpu::download<std::uint32_t>(context, exchange.links(body));
    const auto sides = gpu::download<ExchangeSide>(context, exchange.sides(body));
    ASSERT_EQ(links.size(), directions * sides.size());
    for (std::size_t at = body; at < links.size(); at += 29) {  // a sample of them
      const ExchangeSide side = sides[at % sides.size()];
      const Receiver& r = parts[body]->receivers[side.entry];
      const glm::dvec3 way = direction(r.normal, side.entry, static_cast<std::uint32_t>(at / sides.size()), directions);
      const glm::dvec3 from = glm::dvec3(r.position) + double(r.slack) * glm::dvec3(r.normal);
      Seen hit;
      glm::dvec3 normal(0);
      for (int o = 0; o < 4; ++o)
        for (const glm::uvec3& t : lit.scene.objects[o].mesh.triangles) {
          const auto& p = lit.scene.objects[o].mesh.positions;
          const glm::dvec3 a = p[t.x], b = p[t.y], c = p[t.z], n = glm::cross(b - a, c - a);
          if (lit.scene.objects[o].role == Role::translucent && glm::dot(n, way) >= 0) continue;
          const double d = hit_distance(from, way, a, b, c);
          if (d < hit.distance) hit = {d, o, t}, normal = glm::normalize(n);
        }
      const std::uint32_t link = links[at], emitter = link & 0xffffffu;
      ++asked;
      bool same = true;
      if (hit.object < 0) {
        ++seen[0], same = link == link_open;
      } else if (hit.object == 1) {
        ++seen[1], same = link < link_emitters && emitter >= places;
      } else if (hit.object == 3) {
        ++seen[3], same = link == link_dark;
      } else {
        ++seen[2];
        const int target = hit.object == 0 ? 0 : 1;
        const std::uint32_t entry = emitter - exchange.first(target);
        same = link != link_open && link != link_dark && emitter < places && emitter >= exchange.first(target) &&
               entry < 2 * parts[target]->cuts.size();
        if (same) {
          const GpuCutCell& cut = parts[target]->cuts[entry / 2];
          const glm::dvec3 place = (from + hit.distance * way - glm::dvec3(parts[target]->domain.frame.origin)) /
                                   double(parts[target]->domain.frame.h);
          const double reflectance = fresnel_reflectance(-glm::dot(way, normal), lit.scene.objects[hit.object].eta);
          same = std::abs(double(link >> 24) / 255 - reflectance) < 0.6 / 255 &&
                 int(entry % 2) == (facet_class(normal) & 1) &&
                 glm::all(glm::lessThan(glm::abs(place - 0.5 - glm::dvec3(cut.cell)), glm::dvec3(0.501)));
        }
      }
      apart += !same;
    }
  }
  for (int count : seen) EXPECT_GT(count, 0);
  EXPECT_LE(apart, asked / 200);  // silhouettes, and places on the border of two cells
  std::printf("%d links: nothing %d, opaque %d, translucent %d, lamp %d; %d apart\n", asked, seen[0], seen[1], seen[2],
              seen[3], apart);
}

// The ball's lights enter apart, and from the third pass on what surfaces had sent in the second.
TEST_F(LightingExchange, GatherEqualsTwin) {
  std::vector<ExchangeBody> both = bodies();
  both[1].lights_apart = true;
  Exchange exchange(context, lit.scene, lit.lighting, both, {directions});
  std::vector<glm::vec3> sent = gpu::download<glm::vec3>(context, exchange.transmitted());
  const std::uint32_t places = exchange.first(1) + 2 * (ball_part.domain.summary.cut_cells + 1);
  std::mt19937 engine(7);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (std::uint32_t i = 0; i < places; ++i) sent[i] = {uniform(engine), uniform(engine), uniform(engine)};
  gpu::upload(context, exchange.transmitted(), sent);

  const Gridded* parts[] = {&torus_part, &ball_part};
  const double etas[] = {1.4, 1.2};
  std::vector<glm::dvec3> mirrored(sent.size(), glm::dvec3(0)), known(sent.size(), glm::dvec3(0)),
      known_mirrored = known;
  for (int pass = 0; pass < 3; ++pass) {
    if (pass == 2) {
      gpu::Commands commands(context);
      exchange.record_known(commands);
      commands.submit();
      known.assign(sent.begin(), sent.end());
      known_mirrored = mirrored;
      for (std::uint32_t i = 0; i < places; ++i) sent[i] *= 0.5f + uniform(engine);
      gpu::upload(context, exchange.transmitted(), sent);
    }
    gpu::Commands gathers(context);
    for (std::size_t body = 0; body < 2; ++body) exchange.record_gather(gathers, body);
    gathers.submit();
    exchange.next_pass();
    std::vector<glm::dvec3> next = mirrored;
    double worst = 0, largest = 0;
    for (std::size_t body = 0; body < 2; ++body) {
      const auto links = gpu::download<std::uint32_t>(context, exchange.links(body));
      const auto sides = gpu::download<ExchangeSide>(context, exchange.sides(body));
      const auto flux = gpu::download<glm::vec3>(context, parts[body]->source.flux());
      const auto direct = gpu::download<glm::vec3>(context, parts[body]->source.direct());
      const std::vector<glm::vec3> irradiance = [&] {  // of the lamps
        const gpu::Buffer out(context, parts[body]->source.direct().bytes(), "irradiance");
        gpu::Commands gather(context);
        lit.lighting.record_gather(gather, parts[body]->source.receivers(), parts[body]->source.count(), 1, out, false);
        gather.submit();
        return gpu::download<glm::vec3>(context, out);
      }();
      const double f_dr = diffuse_reflectance(etas[body]);
      for (std::size_t i = 0; i < sides.size(); ++i) {
        glm::dvec3 through(0), back(0);
        double f_t = 0, f_r = 0;
        for (int k = 0; k < directions; ++k) {
          const double r = fresnel_reflectance(std::sqrt(1 - (k + 0.5) / directions), etas[body]);
          const std::uint32_t link = links[k * sides.size() + i], emitter = link & 0xffffffu;
          glm::dvec3 light(0), not_known(0);
          if (link == link_open)
            light = lit.scene.environment.radiance;
          else if (link != link_dark) {
            const double share = double(link >> 24) / 255;
            light = glm::mix(glm::dvec3(sent[emitter]), mirrored[emitter], share);
            not_known = light - glm::mix(known[emitter], known_mirrored[emitter], share);
          }
          through += (1 - r) * (body == 0 ? light : not_known);
          back += r * light, f_t += 1 - r, f_r += r;
        }
        const std::uint32_t entry = sides[i].entry;
        const glm::dvec3 lamps = direct[entry],
                         expected = (body == 0 ? lamps : glm::dvec3(0)) + M_PI * (1 - f_dr) / f_t * through;
        next[exchange.first(body) + entry] = (glm::dvec3(irradiance[entry]) - lamps) / (M_PI * f_dr) + back / f_r;
        worst = std::max(worst, glm::distance(expected, glm::dvec3(flux[entry])));
        largest = std::max(largest, glm::length(expected));
      }
    }
    mirrored = next;
    EXPECT_GT(largest, 1);
    EXPECT_LT(worst, 1e-5 * largest) << "pass " << pass;
  }
}

TEST_F(LightingExchange, OpaquePlacesSendWhatTheyReceive) {
  // A plate that a uniform environment lights, under a small ball: what the ball sees of it is albedo times the sky,
  // but for the little that the ball keeps from the plate.
  Scene plate_scene;
  Object plate = make_object(Role::opaque, transformed(quad(400, 400), translation({0, -3, 0})));
  plate.albedo = {0.5f, 0.25f, 1};
  plate_scene.objects = {make_object(Role::translucent, icosphere(3, 0.2f)), plate};
  plate_scene.environment.radiance = {1, 1, 1};
  const LitScene under(context, plate_scene, {8, 64, 256});
  const Gridded ball(context, under, 0, 12);
  Exchange exchange(context, under.scene, under.lighting, {{0, ball.domain, ball.source, 1}}, {64});
  gpu::Commands commands(context);
  exchange.record_gather(commands, 0);
  commands.submit();
  const auto flux = gpu::download<glm::vec3>(context, ball.source.flux());
  int down = 0;
  for (const ExchangeSide& side : gpu::download<ExchangeSide>(context, exchange.sides(0))) {
    const double y = ball.receivers[side.entry].normal.y;
    // The plate fills (1 - y) / 2 of the cosine-weighted hemisphere.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(flux[side.entry][c] / M_PI, 1 - (1 - plate.albedo[c]) * (1 - y) / 2, 0.04);
    down += y < -0.9;
  }
  EXPECT_GT(down, 5);
}

TEST_F(LightingExchange, SameEveryTime) {
  std::vector<glm::vec3> first[2];
  for (int run = 0; run < 2; ++run) {
    Exchange exchange(context, lit.scene, lit.lighting, bodies(), {directions});
    for (int pass = 0; pass < 2; ++pass) {
      gpu::Commands commands(context);
      for (std::size_t body = 0; body < 2; ++body) exchange.record_gather(commands, body);
      commands.submit();
      exchange.next_pass();
    }
    for (std::size_t body = 0; body < 2; ++body) {
      const auto flux = gpu::download<glm::vec3>(context, (body ? ball_part : torus_part).source.flux());
      if (run == 0) first[body] = flux;
      EXPECT_TRUE(flux == first[body]);
    }
  }
}

}  // namespace
}  // namespace alabaster
