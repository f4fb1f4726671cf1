// The loops of the occlusion horizon in SIMD (checklist 21.03): boxes against it, many at once, and walls into it.
// Promise: conservative; boxes are projected in single precision, all rounding outwards. All targets give the same
// bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "sightline/core/counters.hpp"
#include "sightline/geometry/frustum_boxes.hpp"

namespace sightline {

/// A view from above, and the intervals of slopes that are hidden in its columns. Across the columns runs u: metres to
/// the right for each metre of plan distance or, orthographic, metres. A slope is a height over the eye for each metre
/// of plan distance or, orthographic, over the ray through the eye.
struct HorizonPlan {
  glm::dvec3 eye{0.0};
  glm::dvec2 forward{0.0}, right{0.0};  // x and z, unit length
  double level = 1, climb = 0;          // the view direction's length in plan and upwards
  double tilt = 0;                      // climb / level
  double near = 0;                      // metres
  double limit = 1, per_u = 1;          // columns run from u = -limit to limit; how many for each unit
  int columns = 0;                      // 1 to 65535
  bool perspective = true;
  bool open_sides = false;                // the view sees beyond the columns
  float *low = nullptr, *high = nullptr;  // by column, padded by 8; low > high: nothing is hidden
};

/// A box as the horizon sees it.
struct HorizonBox {
  std::uint32_t index;        // among the boxes given
  float nearest, farthest;    // along the view's plan direction, metres, rounded outwards
  std::uint16_t first, last;  // the columns that have to hide it; first > last: nothing hides it
  float low, high;            // the slopes that they have to hide
};

/// Those of boxes [begin, end) that touch the frustum and are not hidden, ascending, into `out`, which must hold
/// end - begin. Boxes that begin nearer than `walls_to`, where the farthest wall of the horizon ends, are not hidden.
/// Returns how many. Adds to queries and cells_tested.
std::size_t boxes_over_horizon(const HorizonPlan& plan, const BoxArrays& boxes, std::size_t begin, std::size_t end,
                               const Frustum& frustum, float walls_to, HorizonBox* out, Counters& counters);

/// Where a fence stands: its points' offset and its height, world space, and by how much the real walls may stand
/// aside, metres.
struct HorizonWall {
  double x, z, y0, y1, slack;
};

/// Adds what the walls from each point (x and z) to the next hide to the intervals of their columns, each with the
/// lowest top and the highest foot over its width. `scratch` is kept from call to call to save allocations.
void add_fence(const HorizonPlan& plan, std::span<const glm::dvec2> points, const HorizonWall& wall,
               std::vector<double>& scratch);

/// True if the columns of the box hide its slopes.
bool hidden_by_horizon(const HorizonPlan& plan, const HorizonBox& box, Counters& counters);

}  // namespace sightline
