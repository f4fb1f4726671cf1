// How many pixels a bounding volume covers in a view, at most: the slides' estimate, and the exact areas of ellipse and
// silhouette (checklist 26.03 with E51).
#pragma once

#include <span>

#include "sightline/geometry/hull.hpp"
#include "sightline/geometry/kdop.hpp"
#include "sightline/geometry/obb.hpp"
#include "sightline/geometry/sphere.hpp"
#include "sightline/scene/view.hpp"

namespace sightline {

/// Pixels per unit of x / depth (perspective) or per metre (orthographic).
double pixels_per_unit(const View& view);

/// The slides' estimate in pixels: d = v . (c - e), r^ = r n / d, pi r^2 (26.03), brought from near-plane units to
/// pixels (E51). Too small, above all off the axis; infinity for d <= r, where it is invalid.
double slide_area(const View& view, const Sphere& sphere);

/// The area of the ellipse (orthographic: circle) that the sphere projects to, in pixels, not cut by the image's
/// border; infinity if the sphere reaches the plane of the eye, where the projection is not bounded.
double ellipse_area(const View& view, const Sphere& sphere);

/// The area in pixels of the convex hull of the projected points: the silhouette of a convex volume with these corners.
/// Infinity if a corner does not lie before the plane of the eye.
double silhouette_area(const View& view, std::span<const glm::vec3> corners);

/// An upper bound for the pixels of the image that anything inside the volume can cover: the area above, at most the
/// image's. By its corners for all but the sphere.
double screen_area_bound(const View& view, const Sphere& sphere);
double screen_area_bound(const View& view, const Aabb& box);
double screen_area_bound(const View& view, const Obb& box);
double screen_area_bound(const View& view, const Kdop& kdop);
double screen_area_bound(const View& view, const ConvexHull& hull);

}  // namespace sightline
