// Flat parts of a mesh as few large triangles: triangles that lie in one plane exactly and hang together are merged to
// polygons, corners on straight borders are dropped where all neighbours drop them too, and the rest is triangulated
// anew. As point sets a patch and its triangles are equal, so it hides what they hide and nothing more.
#pragma once

#include <cstdint>
#include <vector>

#include "sightline/scene/scene.hpp"

namespace sightline {

struct Patch {
  std::vector<glm::uvec3> triangles;  // corners are vertices of the mesh, by the lowest index at each position
  double area = 0;                    // in the mesh's space
  std::uint32_t original = 0;         // how many triangles of the mesh it stands for
};

/// Every triangle of the mesh with three different corners is in exactly one patch. Exact where planes are
/// perpendicular to an axis or all coordinates are whole multiples of a power of two with at most 30 bits; triangles of
/// other planes stay as they are. Patches whose outline touches itself, or has more than most_concave_corners, stay as
/// they are. O(n log n) but for the triangulation.
std::vector<Patch> coplanar_patches(const std::vector<glm::vec3>& positions, const std::vector<glm::uvec3>& triangles);

}  // namespace sightline
