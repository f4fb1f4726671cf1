// Boxes that lie inside a closed mesh, from a voxel grid: cells that no triangle touches and around which the surface
// winds. Whoever looks from outside of the mesh's bounds has surface in front of every point of such a box, so the
// boxes hide what the mesh hides and nothing more.
#pragma once

#include <vector>

#include "sightline/scene/scene.hpp"

namespace sightline {

struct SolidBoxConfig {
  int cells = 16;      // of the grid along each axis, 4 to 128
  int boxes = 6;       // at most so many
  double gain = 0.05;  // stop when a box adds less than this share of the mesh's bounds' surface
};

/// Largest first; they may overlap. Empty for a mesh that is not closed. Mesh space. O(triangles + cells^3).
std::vector<Aabb> solid_boxes(const Mesh& mesh, const SolidBoxConfig& config = {});

/// How often a closed surface winds around a point: 0 outside. Sum of solid angles (van Oosterom and Strackee 1983).
int winding_number(const Mesh& mesh, const glm::dvec3& point);

}  // namespace sightline
