// Building blocks of generated scenes: closed solids with outward, counter-clockwise faces, in their own space, metres.
// All are free of T-junctions, so that their edges pair up exactly (checklist 17.01, 17.06).
#pragma once

#include <glm/glm.hpp>
#include <span>
#include <string>
#include <vector>

#include "sightline/scene/scene.hpp"

namespace sightline {

/// The solid between two corners; low < high on every axis. 12 triangles.
Mesh make_box(const glm::vec3& low, const glm::vec3& high);

/// Corners of a regular polygon of circumradius 1, >= 3 sides, in the order that make_lathe wants.
std::vector<glm::vec2> round_section(int sides);
/// Corners of the square from (-1, -1) to (1, 1).
std::vector<glm::vec2> square_section();

/// Rings of a horizontal section (x, z), scaled by profile.x at height profile.y, from the bottom up and closed by
/// caps. The first and last profile point may have width 0 (a tip). Equal heights make ledges. At least two points.
Mesh make_lathe(std::span<const glm::vec2> profile, std::span<const glm::vec2> section);

/// Upright cylinder of radius 1 from y = 0 to 1.
Mesh make_cylinder(int sides);
/// Ball of radius 1 around the origin; rings >= 2.
Mesh make_ball(int sides, int rings);
/// A ridge along x: triangle of width 1 (z) and height 1 (y), base at y = 0, length 1, centred in x and z.
Mesh make_gable();

/// An upright plate of grid cells: `u` (x) and `v` (y) hold ascending grid lines, filled[row * columns + column] tells
/// which cells are solid; it reaches from z = -thickness / 2 to thickness / 2. Solid cells must not meet at a corner
/// alone.
Mesh make_plate(std::span<const float> u, std::span<const float> v, std::span<const char> filled, float thickness);

/// A rectangle in the plate of make_wall that is left open.
struct Opening {
  float left, bottom, right, top;
};
/// A wall from (0, bottom) to (width, top) with openings strictly inside, or reaching its edges.
Mesh make_wall(float width, float bottom, float top, float thickness, std::span<const Opening> openings);

/// A pipe of radius `radius` along a polyline (>= 2 points, no two neighbours equal, bends below half a turn), with
/// caps.
Mesh make_pipe(std::span<const glm::vec3> points, float radius, int sides);

/// Appends a transformed copy; a mirroring transform keeps the faces outward.
void append(Mesh& mesh, const Mesh& part, const Affine& transform = identity_affine());

/// Splits triangles, without changing the shape, until there are `triangles` or one more (never fewer than now). Every
/// triangle first into equal parts, then longest edges first. Edges that were shared stay shared.
Mesh refine(const Mesh& mesh, std::size_t triangles);

/// Six times the enclosed volume; positive if the faces of a closed mesh point outwards.
double signed_volume6(const Mesh& mesh);

}  // namespace sightline
