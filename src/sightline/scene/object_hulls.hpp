// The few points of an object from which all its bounding volumes follow: the corners of its mesh's convex hull in
// world space. One hull for each mesh, however many objects place it.
#pragma once

#include <vector>

#include "sightline/geometry/hull.hpp"
#include "sightline/scene/scene.hpp"

namespace sightline {

/// The convex hull of every mesh, in mesh space, by mesh id. Parallel.
std::vector<ConvexHull> mesh_hulls(const Scene& scene);

/// The hull of an object: the mesh's hull placed by the transform (mirrors keep the outside outside). `slack` covers
/// the rounding of the corners.
ConvexHull placed_hull(const ConvexHull& mesh_hull, const Affine& transform);

}  // namespace sightline
