// Ray against plane and planar polygon (checklist 13.06 with E23).
#pragma once

#include <optional>
#include <span>

#include "sightline/geometry/ray.hpp"

namespace sightline {

/// Parameter at which the ray, within its interval, meets the plane (x - point) . normal = 0; the normal may have any
/// length. Nothing if the ray runs along the plane (also within it: a whole line of points is no hit), if the normal is
/// zero or not finite, or if there is no ray.
std::optional<double> hit_plane(const Ray& ray, const glm::vec3& point, const glm::vec3& normal);

/// The same for a simple planar polygon, convex or not, of three or more corners in either order; its plane is that of
/// Newell's normal. The border belongs to it as far as rounding tells: of two polygons at an edge one is hit at least
/// where their corners are bit by bit the same and both are convex. A polygon without area is never hit.
std::optional<double> hit_polygon(const Ray& ray, std::span<const glm::vec3> corners);

}  // namespace sightline
