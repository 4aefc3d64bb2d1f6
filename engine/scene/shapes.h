// Generated meshes for tests, demos and studies. All but quad() are closed, wound counter-clockwise seen from outside,
// share their vertices, and lie around the origin; lengths in metres.
#pragma once

#include "scene/scene.h"

namespace alabaster {

/// A subdivided icosahedron, 20 * 4^subdivisions triangles, its vertices on the sphere (its volume is a little
/// smaller).
Mesh icosphere(int subdivisions, float radius = 1);

/// A sphere of `rings` bands between the poles (y axis) and `segments` around; at least 2 and 3.
Mesh uv_sphere(int rings, int segments, float radius = 1);

/// icosphere() stretched to the half axes `radii`.
Mesh ellipsoid(int subdivisions, glm::vec3 radii);

/// A box with the edge lengths `size`; each face is cut into divisions x divisions x 2 triangles. Plates are flat
/// boxes.
Mesh box(glm::vec3 size, int divisions = 1);

/// A torus around the y axis: `major_radius` to the middle of the tube, `minor_radius` of the tube.
Mesh torus(float major_radius, float minor_radius, int major_segments, int minor_segments);

/// A cylinder along y, capped by fans. Needles are thin ones.
Mesh cylinder(float radius, float height, int segments, int stacks = 1);

/// An open rectangle in the plane y = 0, its front side up (+y).
Mesh quad(float size_x, float size_z);

/// `mesh` with positions moved by `matrix`; winding is turned where the matrix mirrors, so that outside stays outside.
Mesh transformed(Mesh mesh, const glm::dmat4& matrix);

/// The same triangles seen from the other side.
Mesh flipped(Mesh mesh);

/// Both meshes in one (nothing is welded).
Mesh joined(Mesh a, const Mesh& b);

/// A rotation about `axis` by `degrees`, as a matrix for transformed().
glm::dmat4 rotation(glm::dvec3 axis, double degrees);
glm::dmat4 translation(glm::dvec3 offset);
glm::dmat4 scaling(glm::dvec3 factors);

/// The frame of a camera (or a light quad's holder) at `eye` that looks at `target` along -z with y up.
glm::mat4 look_at(glm::dvec3 eye, glm::dvec3 target, glm::dvec3 up = {0, 1, 0});

/// Volume enclosed, m^3: positive when the winding is outward.
double signed_volume(const Mesh& mesh);

/// Sum of the triangles' areas, m^2, and of their area vectors (0 for a closed mesh).
double area(const Mesh& mesh);
glm::dvec3 area_vector(const Mesh& mesh);

}  // namespace alabaster
