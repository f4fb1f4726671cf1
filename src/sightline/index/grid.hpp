// Uniform grid of voxels (checklist 14.01-14.03) and the walk of a ray through it (Amanatides and Woo 1987; 13.16 with
// E24: a hit counts only once no nearer cell is left, and a triangle in many cells is tested once). Promise: the hits
// of brute force.
#pragma once

#include "sightline/geometry/frustum.hpp"
#include "sightline/index/trace.hpp"

namespace sightline {

struct GridConfig {
  double cells_per_triangle = 2.0;      // > 0; cells are as near to cubes as the bounds allow
  std::uint32_t most_cells = 1u << 25;  // n^3 is the drawback (14.03): never more
};

struct Grid {
  TraceSpace space;
  glm::dvec3 origin{0.0}, cell{1.0};  // corner of the first cell and size of each, metres
  glm::ivec3 resolution{0};           // cells along each axis; 0 if there are no triangles
  /// Triangles that touch cell i = x + nx (y + ny z), ascending: items[starts[i] .. starts[i + 1]).
  std::vector<std::uint32_t> starts, items;

  [[nodiscard]] std::size_t bytes() const { return 4 * (starts.size() + items.size()); }
};

Grid build_grid(const TriangleSoup& soup, const GridConfig& config = {});

RayHit trace_nearest(const Grid& grid, const TriangleSoup& soup, const Ray& ray, TraceCounters& counters);
bool trace_any(const Grid& grid, const TriangleSoup& soup, const Ray& ray, TraceCounters& counters);

/// Places of the triangles that touch the box / the frustum; ascending.
std::vector<std::uint32_t> box_query(const Grid& grid, const TriangleSoup& soup, const Aabb& box);
std::vector<std::uint32_t> frustum_query(const Grid& grid, const TriangleSoup& soup, const Frustum& frustum);

}  // namespace sightline
