#include "sightline/index/grid.hpp"

#include <cmath>

#include "sightline/geometry/triangle_overlap.hpp"
#include "sightline/index/cell_items.hpp"

namespace sightline {
namespace {

glm::ivec3 cell_of(const Grid& grid, const glm::dvec3& p) {
  glm::ivec3 cell(0);
  for (int axis = 0; axis < 3; ++axis) {
    const double place = (p[axis] - grid.origin[axis]) / grid.cell[axis];
    cell[axis] = static_cast<int>(std::clamp(std::floor(place), 0.0, static_cast<double>(grid.resolution[axis] - 1)));
  }
  return cell;
}

std::size_t index_of(const Grid& grid, const glm::ivec3& c) {
  return static_cast<std::size_t>(c.x) +
         static_cast<std::size_t>(grid.resolution.x) *
             (static_cast<std::size_t>(c.y) +
              static_cast<std::size_t>(grid.resolution.y) * static_cast<std::size_t>(c.z));
}

Aabb box_of(const Grid& grid, const glm::ivec3& c) {
  const glm::dvec3 lo = grid.origin + glm::dvec3(c) * grid.cell;
  Aabb box{glm::vec3(lo), glm::vec3(lo + grid.cell)};
  for (int axis = 0; axis < 3; ++axis) {  // rounded outwards: far from the origin a float is coarser than the slack
    box.lo[axis] = std::nextafter(box.lo[axis], -std::numeric_limits<float>::infinity());
    box.hi[axis] = std::nextafter(box.hi[axis], std::numeric_limits<float>::infinity());
  }
  return box;
}

/// Calls f(cell index) for the cells that a triangle may touch, widened so that rounding of rays loses none.
template <class F>
void for_cells(const Grid& grid, const glm::vec3* corners, F&& f) {
  const double margin = 3.0 * static_cast<double>(grid.space.slack);
  const Aabb bounds = triangle_bounds(corners);
  const glm::ivec3 lo = cell_of(grid, glm::dvec3(bounds.lo) - margin),
                   hi = cell_of(grid, glm::dvec3(bounds.hi) + margin);
  const int spans = (hi.x > lo.x ? 1 : 0) + (hi.y > lo.y ? 1 : 0) + (hi.z > lo.z ? 1 : 0);
  for (int z = lo.z; z <= hi.z; ++z)
    for (int y = lo.y; y <= hi.y; ++y)
      for (int x = lo.x; x <= hi.x; ++x)
        if (spans <= 1 || triangle_touches_box(corners, box_of(grid, {x, y, z}), margin)) f(index_of(grid, {x, y, z}));
}

void choose_resolution(Grid& grid, std::size_t triangles, const GridConfig& config) {
  const glm::dvec3 extent(grid.cell);
  const double longest = std::max({extent.x, extent.y, extent.z});
  const double wanted =
      std::min(config.cells_per_triangle * static_cast<double>(triangles), static_cast<double>(config.most_cells));
  // Flat bounds: an axis that is short for its cells gets one.
  double side = std::cbrt(extent.x * extent.y * extent.z / wanted);
  for (int round = 0; round < 3; ++round) {
    double volume = 1.0;
    int axes = 0;
    for (int axis = 0; axis < 3; ++axis)
      if (extent[axis] > side) {
        volume *= extent[axis];
        ++axes;
      }
    if (axes > 0) side = std::pow(volume / wanted, 1.0 / axes);
  }
  for (int axis = 0; axis < 3; ++axis)
    grid.resolution[axis] =
        static_cast<int>(std::clamp(std::floor(extent[axis] / std::max(side, 1e-9 * longest)), 1.0, 65535.0));
  for (int axis = 0; axis < 3; ++axis) grid.cell[axis] = extent[axis] / grid.resolution[axis];
}

template <bool any>
RayHit walk(const Grid& grid, const TriangleSoup& soup, const TraceRay& ray, TraceCounters& counters) {
  RayHit best{ray.t_far, no_triangle};
  const glm::dvec3 origin(ray.origin), size = grid.cell * glm::dvec3(grid.resolution);
  glm::dvec3 inverse(0.0);
  double enter = static_cast<double>(ray.t_near), leave = static_cast<double>(ray.t_far);
  for (int axis = 0; axis < 3; ++axis) {
    const auto d = static_cast<double>(ray.direction[axis]);
    const double from = grid.origin[axis] - origin[axis], to = from + size[axis];
    inverse[axis] = d == 0.0 ? std::numeric_limits<double>::infinity() : 1.0 / d;
    if (d == 0.0) {
      if (from > 0.0 || to < 0.0) return best;
      continue;
    }
    enter = std::max(enter, (d > 0.0 ? from : to) * inverse[axis]);
    leave = std::min(leave, (d > 0.0 ? to : from) * inverse[axis]);
  }
  if (!(enter <= leave)) return best;
  glm::ivec3 cell = cell_of(grid, origin + enter * glm::dvec3(ray.direction));
  glm::dvec3 next(std::numeric_limits<double>::infinity());  // parameter at which each axis leaves the cell
  glm::ivec3 step(0);
  const auto border = [&](int axis) {
    const int at = cell[axis] + (step[axis] > 0 ? 1 : 0);
    return (grid.origin[axis] + at * grid.cell[axis] - origin[axis]) * inverse[axis];
  };
  std::ptrdiff_t stride[3];
  std::ptrdiff_t across = 1;
  for (int axis = 0; axis < 3; ++axis) {
    step[axis] = ray.direction[axis] > 0.0f ? 1 : ray.direction[axis] < 0.0f ? -1 : 0;
    if (step[axis] != 0) next[axis] = border(axis);
    stride[axis] = across * step[axis];
    across *= grid.resolution[axis];
  }
  auto at = static_cast<std::ptrdiff_t>(index_of(grid, cell));
  Mailbox mailbox;
  for (;;) {
    ++counters.nodes;
    const auto c = static_cast<std::size_t>(at);
    if (test_items<any>(std::span(grid.items).subspan(grid.starts[c], grid.starts[c + 1] - grid.starts[c]), soup, ray,
                        mailbox, counters, best) &&
        any)
      return best;
    const int axis = next.x <= next.y && next.x <= next.z ? 0 : next.y <= next.z ? 1 : 2;
    // The in-cell rule: a hit beyond this cell may have a nearer one before it.
    if (static_cast<double>(best.t) < next[axis]) return best;
    cell[axis] += step[axis];
    if (cell[axis] < 0 || cell[axis] >= grid.resolution[axis] || !(next[axis] <= leave)) return best;
    at += stride[axis];
    next[axis] = border(axis);
  }
}

template <bool any>
RayHit trace(const Grid& grid, const TriangleSoup& soup, const Ray& ray, TraceCounters& counters) {
  ++counters.rays;
  TraceRay prepared;
  if (grid.resolution.x == 0 || !prepare(ray, grid.space, prepared)) return {};
  return finish(prepared, walk<any>(grid, soup, prepared, counters));
}

}  // namespace

Grid build_grid(const TriangleSoup& soup, const GridConfig& config) {
  Grid grid;
  if (soup.size() == 0) return grid;
  grid.space = trace_space(bounds_of(soup));
  // Never flat, also where all corners lie at one place.
  const double far = static_cast<double>(reach(grid.space.bounds));
  const glm::dvec3 margin(std::max(8.0 * static_cast<double>(grid.space.slack), 1e-9 * far));
  grid.origin = glm::dvec3(grid.space.bounds.lo) - margin;
  grid.cell = glm::dvec3(grid.space.bounds.hi) + margin - grid.origin;
  choose_resolution(grid, soup.size(), config);
  const std::size_t cells = index_of(grid, grid.resolution - 1) + 1;
  grid.starts.assign(cells + 1, 0);
  for (std::uint32_t i = 0; i < soup.size(); ++i)
    for_cells(grid, soup.triangle(i), [&](std::size_t cell) { ++grid.starts[cell + 1]; });
  for (std::size_t i = 0; i < cells; ++i) grid.starts[i + 1] += grid.starts[i];
  grid.items.resize(grid.starts[cells]);
  std::vector<std::uint32_t> fill(grid.starts.begin(), grid.starts.end() - 1);
  for (std::uint32_t i = 0; i < soup.size(); ++i)
    for_cells(grid, soup.triangle(i), [&](std::size_t cell) { grid.items[fill[cell]++] = i; });
  return grid;
}

RayHit trace_nearest(const Grid& grid, const TriangleSoup& soup, const Ray& ray, TraceCounters& counters) {
  return trace<false>(grid, soup, ray, counters);
}

bool trace_any(const Grid& grid, const TriangleSoup& soup, const Ray& ray, TraceCounters& counters) {
  return trace<true>(grid, soup, ray, counters).found();
}

std::vector<std::uint32_t> box_query(const Grid& grid, const TriangleSoup& soup, const Aabb& box) {
  std::vector<std::uint32_t> found;
  if (grid.resolution.x == 0 || box.empty()) return found;
  const glm::ivec3 lo = cell_of(grid, glm::dvec3(box.lo)), hi = cell_of(grid, glm::dvec3(box.hi));
  for (int z = lo.z; z <= hi.z; ++z)
    for (int y = lo.y; y <= hi.y; ++y)
      for (int x = lo.x; x <= hi.x; ++x) {
        const std::size_t cell = index_of(grid, {x, y, z});
        found.insert(found.end(), grid.items.begin() + grid.starts[cell], grid.items.begin() + grid.starts[cell + 1]);
      }
  return unique_places(std::move(found), soup,
                       [&](const glm::vec3* corners) { return triangle_touches_box(corners, box); });
}

std::vector<std::uint32_t> frustum_query(const Grid& grid, const TriangleSoup& soup, const Frustum& frustum) {
  std::vector<std::uint32_t> found;
  for (int z = 0; z < grid.resolution.z; ++z)
    for (int y = 0; y < grid.resolution.y; ++y)
      for (int x = 0; x < grid.resolution.x; ++x) {
        const std::size_t cell = index_of(grid, {x, y, z});
        if (grid.starts[cell] == grid.starts[cell + 1]) continue;
        if (classify(frustum, box_of(grid, {x, y, z})) == Containment::outside) continue;
        found.insert(found.end(), grid.items.begin() + grid.starts[cell], grid.items.begin() + grid.starts[cell + 1]);
      }
  return unique_places(std::move(found), soup,
                       [&](const glm::vec3* corners) { return triangle_touches_frustum(corners, frustum); });
}

}  // namespace sightline
