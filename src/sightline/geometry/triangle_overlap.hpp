// Whether a triangle reaches into a box (Akenine-Moller 2001, separating axes) or a frustum (by clipping), in double.
#pragma once

#include "sightline/geometry/frustum.hpp"

namespace sightline {

/// True if the closed triangle and the closed box, widened by `margin` on every side, have a point in common, up to
/// rounding in double. Corners finite; a triangle without area counts as the segment or point that it is.
bool triangle_touches_box(const glm::vec3* corners, const Aabb& box, double margin = 0.0);

/// True if some of the triangle lies inside of all planes.
bool triangle_touches_frustum(const glm::vec3* corners, const Frustum& frustum);

}  // namespace sightline
