// Bounding spheres (checklist 20.02, 20.10, 20.15, E40): the smallest one (Welzl 1991) and a quick one (Ritter 1990).
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "sightline/geometry/frustum.hpp"

namespace sightline {

/// Closed ball. A negative radius is an empty one.
struct Sphere {
  glm::vec3 centre{0.0f};
  float radius = -1.0f;
};

/// The smallest sphere around the points, radius rounded up so that it holds all of them. Expected O(n).
Sphere smallest_sphere(std::span<const glm::vec3> points);

/// Two passes: between two far points, then grown (Ritter 1990). Holds all points; a few per cent too large.
Sphere ritter_sphere(std::span<const glm::vec3> points);

/// Outside is certain; "inside" up to the frustum's slack. Near edges and corners of the frustum a sphere outside may
/// count as intersecting (E40).
Containment classify(const Frustum& frustum, const Sphere& sphere);

inline bool overlaps(const Sphere& a, const Sphere& b) {
  const float reach = a.radius + b.radius;
  return glm::dot(a.centre - b.centre, a.centre - b.centre) <= reach * reach * (1.0f + 1e-6f);
}

}  // namespace sightline
