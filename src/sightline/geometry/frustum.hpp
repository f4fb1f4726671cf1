// View frustum as planes, and the box test by p- and n-vertices (Assarsson and Moller 2000; checklist 20.09-20.14,
// E42). Promise of the tests: conservative; a box near a frustum edge may count as intersecting though it is outside
// (E40).
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "sightline/geometry/aabb.hpp"

namespace sightline {

/// Half-space: a point p is inside iff dot(normal, p) + offset >= 0. The normal has unit length and points inwards.
struct Plane {
  glm::vec3 normal{0.0f};
  float offset = 0.0f;
};

enum class Containment { outside, intersecting, inside };

/// The convex region inside of `count` planes (left, right, bottom, top, near, and far unless far is infinite).
/// Offsets are already moved outwards by the rounding slack of the coordinates they are meant for.
struct Frustum {
  std::array<Plane, 6> planes{};
  int count = 0;
};

/// Where `box` lies relative to one plane.
inline Containment classify(const Plane& plane, const Aabb& box) {
  const glm::vec3& n = plane.normal;
  const glm::vec3 p{n.x >= 0 ? box.hi.x : box.lo.x, n.y >= 0 ? box.hi.y : box.lo.y, n.z >= 0 ? box.hi.z : box.lo.z};
  if (glm::dot(n, p) + plane.offset < 0.0f) return Containment::outside;
  const glm::vec3 q{n.x >= 0 ? box.lo.x : box.hi.x, n.y >= 0 ? box.lo.y : box.hi.y, n.z >= 0 ? box.lo.z : box.hi.z};
  return glm::dot(n, q) + plane.offset < 0.0f ? Containment::intersecting : Containment::inside;
}

/// Where `box` lies relative to the frustum. `outside` is certain; `inside` is certain up to the slack.
inline Containment classify(const Frustum& frustum, const Aabb& box) {
  Containment result = Containment::inside;
  for (int i = 0; i < frustum.count; ++i) {
    const Containment c = classify(frustum.planes[static_cast<std::size_t>(i)], box);
    if (c == Containment::outside) return c;
    if (c == Containment::intersecting) result = c;
  }
  return result;
}

/// The planes of an OpenGL clip matrix (Gribb and Hartmann 2001), each moved outwards by the rounding error of a float
/// evaluation on coordinates up to `reach` (metres). A plane that the matrix does not have (infinite far) is left out.
Frustum frustum_of(const glm::dmat4& view_projection, double reach);

}  // namespace sightline
