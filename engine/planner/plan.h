// What will be computed for a scene, and why: (Scene, what the user asked for) -> Plan. Everything after it obeys the
// plan and decides nothing by itself.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace alabaster {

// How light enters and leaves. report: on the surface, diffusely, and leaves by Eq. 14 divided by eta^2; as_printed:
// without that division; directional: by the refracted direction of each light sample; beam: where its refracted beam
// deposits it; gather: as beam, and leaves by a gather along the refracted view ray.
enum class Transport { report, as_printed, directional, beam, gather };
/// All names of transports, in the enum's order.
inline constexpr const char* transport_names[] = {"report", "as-printed", "directional", "beam", "gather"};
enum class Component { multiple, single, surface };
/// All names of components, in the enum's order.
inline constexpr const char* component_names[] = {"multiple", "single", "surface"};
enum class Quality { preview, balanced, accurate };

const char* name_of(Transport transport);

const char* name_of(Component component);

/// Of a render that does not say: the gather came nearest to the path tracer on every scene measured; a preview takes
/// the report's, which costs less.
inline Transport usual_transport(Quality quality) {
  return quality == Quality::preview ? Transport::report : Transport::gather;
}

/// What the user asked for; an empty optional leaves the choice to the planner.
struct Request {
  glm::ivec2 size{640, 480};  // pixels
  std::string camera;         // its name; empty: the scene's first
  std::optional<int> grid;    // cells along the longest side of each translucent object
  double tolerance = 1e-6;    // relative true residual of the solver
  Transport transport = Transport::report;
  std::optional<std::set<Component>> components;  // without `single`, `multiple` carries it
  Quality quality = Quality::balanced;
  std::optional<int> light_samples;
  std::optional<int> interreflections;     // passes at most; 0: none
  std::optional<int> exchange_directions;  // of each facet
};

struct Plan {
  glm::ivec2 size{0};
  Camera camera;
  Transport transport = Transport::report;
  std::set<Component> components;
  int grid = 0;  // cells along the longest side of each translucent object
  double tolerance = 0;
  int channels = 3;             // 1 where materials and lights are grey: one solve serves red, green and blue
  int light_samples = 0;        // points on area lights, where there are any
  int pixel_samples = 4;        // on a regular grid
  int environment_samples = 0;  // directions in which the environment's occlusion is looked up; 0 without environment
  int shadow_map_size = 512;    // texels
  // Light between surfaces: passes at most (it stops when what is still under way is below 1e-4 of the light) and
  // directions of each facet.
  int interreflections = 0;
  int exchange_directions = 24;
  std::vector<std::string> reasons;  // one line each
};

/// Device memory that the scene's objects need at a grid of `grid` cells, by plan.transport, channels and
/// interreflections: for each cell of the box of an object's grid 90 bytes and 125 a channel (177 with beams), and for
/// each cell that its surface cuts 1000, 500 with beams, and 50 a direction of light between surfaces; and the shadow
/// maps.
std::uint64_t bytes_needed(const Scene& scene, const Plan& plan, int grid);

/// Throws UserError for an unknown camera, a camera inside an object, or a grid outside what is supported.
/// `heap_bytes` is the device's memory: a grid that cannot fit is refused here, before anything is allocated.
Plan make_plan(const Scene& scene, const Request& request, std::uint64_t heap_bytes);

}  // namespace alabaster
