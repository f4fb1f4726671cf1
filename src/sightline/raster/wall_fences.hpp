// The vertical walls of a mesh, as fences: rectangles that stand on a line in plan and reach from one height to
// another, joined where they share an upright edge. What a 2.5-D occlusion horizon may be built from (checklist 21.03):
// every fence is part of the surface, proven from its triangles, whatever the mesh is.
#pragma once

#include <cstdint>
#include <vector>

#include "sightline/scene/scene.hpp"

namespace sightline {

/// A chain of wall rectangles, one from each point of `plan` to the next; a loop repeats its first point at the end.
struct WallFence {
  std::vector<glm::dvec2> plan;  // x and z, metres
  double y0 = 0, y1 = 0;         // from where to where every rectangle is solid
};

struct WallFences {
  std::vector<WallFence> fences;
  /// The triangles' points lie at most this far from the ideal rectangles, metres.
  double slack = 0;
};

/// The fences of a mesh whose points are mapped by `linear` (no translation; y is up afterwards). A wall is a connected
/// patch of coplanar upright triangles, from which the largest rectangle over its full width is kept; patches with
/// holes in it are left out. O(n log n).
WallFences find_wall_fences(const Mesh& mesh, const glm::dmat3& linear);

}  // namespace sightline
