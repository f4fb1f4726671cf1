// Discrete oriented polytopes (Klosowski 1998; checklist 20.06): intersections of slabs of k / 2 fixed directions,
// k = 6, 14, 18 or 26.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <span>

#include "sightline/geometry/hull.hpp"

namespace sightline {

/// The first 3 directions are the axes (6-DOP); 14 adds the four diagonals of the cube, 18 instead the six of its
/// sides, 26 both. Components are -1, 0 or 1.
std::span<const glm::vec3> kdop_directions(int k);

struct Kdop {
  int k = 0;  // 6, 14, 18 or 26; 0 is empty
  std::array<float, 13> lo{}, hi{};
};

/// The smallest k-DOP of the points, rounded outwards.
Kdop make_kdop(std::span<const glm::vec3> points, int k);

/// Its corners and faces: what frustum test, volume and surface are taken from.
ConvexHull polytope(const Kdop& kdop);

/// False only if a slab parts them; both of the same k. The quick test of k-DOP against the k-DOP of a frustum.
bool overlaps(const Kdop& a, const Kdop& b);

}  // namespace sightline
