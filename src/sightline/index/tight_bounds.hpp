// Tight bounding volumes (checklist 24): the polygons of a mesh in clusters, a box around each, the volume their union.
// More boxes hide more, and cost more to ask: the sigma rule says when to stop (24.05 with E49).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/geometry/aabb.hpp"

namespace sightline {

struct TightBoundsConfig {
  double sigma = 1.4;  // the union's surface may be so many times that of the mesh's box, >= 1 (24.06)
  int depth = 8;       // cuts above one another, 0 to 16
  int boxes = 32;      // at most so many, 1 to 256
};

/// Boxes that together hold every triangle, each cut off only while the surface of their union stays within sigma times
/// the surface of the *original* box (E49). The box whose cut saves most volume is cut first, along the axis
/// and at the place where the two halves have the least surface. One box if there is nothing to gain; none without
/// triangles.
struct TightBounds {
  std::vector<Aabb> boxes;
  /// The box that each triangle is in.
  std::vector<std::uint32_t> box_of;
};
TightBounds tight_bounds(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                         const TightBoundsConfig& config = {});

/// Surface and volume of the union of boxes, exact: faces that two boxes share do not count (E49).
double union_surface(std::span<const Aabb> boxes);
double union_volume(std::span<const Aabb> boxes);

}  // namespace sightline
