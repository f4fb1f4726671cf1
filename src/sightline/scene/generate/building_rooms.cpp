#include "sightline/scene/generate/building_rooms.hpp"

#include <algorithm>
#include <cmath>

namespace sightline {

using namespace building;

namespace {

Aabb storey_box(std::uint32_t level, double x0, double z0, double x1, double z1) {
  const double bottom = level * storey - 0.5 * slab;
  return {glm::vec3(x0, bottom, z0), glm::vec3(x1, bottom + storey, z1)};
}

// The range of indices 0 .. count - 1 of pieces of length `pitch` that the interval may touch.
std::pair<std::uint32_t, std::uint32_t> pieces(double low, double high, double pitch, std::uint32_t count) {
  const double last = static_cast<double>(count - 1);
  const double a = std::clamp(std::floor(low / pitch) - 1.0, 0.0, last);
  const double b = std::clamp(std::floor(high / pitch) + 1.0, 0.0, last);
  return {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)};
}

}  // namespace

Aabb BuildingPlan::interior() const {
  return {glm::vec3(-building::corridor, -0.5 * slab, 0),
          glm::vec3(length_x(), storeys * storey - 0.5 * slab, length_z())};
}

BuildingPlan plan_building(std::uint32_t rooms) {
  BuildingPlan plan;
  while (plan.storeys * plan.storeys * plan.storeys * 20 <= rooms) ++plan.storeys;
  const double per_storey = static_cast<double>(rooms) / plan.storeys;
  // Corridors about ten rooms long per side in small buildings, a plan of about equal sides in large ones.
  plan.rows = std::max(1u, static_cast<std::uint32_t>(std::sqrt(0.5 * per_storey * bay / BuildingPlan::row_pitch)));
  plan.bays = std::max(1u, static_cast<std::uint32_t>(std::lround(per_storey / (2.0 * plan.rows))));
  return plan;
}

std::vector<Cell> building_cells(const BuildingPlan& plan) {
  std::vector<Cell> cells(plan.outside() + 1);
  for (std::uint32_t s = 0; s < plan.storeys; ++s) {
    const std::string prefix = "storey " + std::to_string(s) + ' ';
    for (std::uint32_t row = 0; row < plan.rows; ++row) {
      for (std::uint32_t side = 0; side < 2; ++side)
        for (std::uint32_t b = 0; b < plan.bays; ++b) {
          Cell& cell = cells[plan.room(s, row, side, b)];
          const double z = BuildingPlan::room_z(row, side);
          cell.name = prefix + "room " + std::to_string((row * 2 + side) * plan.bays + b);
          cell.bounds = storey_box(s, b * bay, z, (b + 1) * bay, z + depth);
        }
      Cell& corridor_cell = cells[plan.corridor(s, row)];
      const double z = BuildingPlan::corridor_z(row);
      corridor_cell.name = prefix + "corridor " + std::to_string(row);
      corridor_cell.bounds = storey_box(s, 0, z, plan.length_x(), z + building::corridor);
    }
    Cell& cross = cells[plan.cross_corridor(s)];
    cross.name = prefix + "cross corridor";
    cross.bounds = storey_box(s, -building::corridor, 0, 0, plan.length_z());
  }
  cells[plan.outside()].name = "outside";
  return cells;
}

std::vector<std::uint32_t> cells_touching(const BuildingPlan& plan, const std::vector<Cell>& cells, const Aabb& box) {
  std::vector<std::uint32_t> touched;
  const auto test = [&](std::uint32_t cell) {
    if (cells[cell].bounds.overlaps(box)) touched.push_back(cell);
  };
  const auto [s0, s1] = pieces(box.lo.y, box.hi.y, storey, plan.storeys);
  const auto [row0, row1] = pieces(box.lo.z, box.hi.z, BuildingPlan::row_pitch, plan.rows);
  const auto [b0, b1] = pieces(box.lo.x, box.hi.x, bay, plan.bays);
  for (std::uint32_t s = s0; s <= s1; ++s) {
    for (std::uint32_t row = row0; row <= row1; ++row) {
      for (std::uint32_t side = 0; side < 2; ++side)
        for (std::uint32_t b = b0; b <= b1; ++b) test(plan.room(s, row, side, b));
      test(plan.corridor(s, row));
    }
    test(plan.cross_corridor(s));
  }
  const Aabb inside = plan.interior();
  const bool within = glm::all(glm::greaterThan(box.lo, inside.lo)) && glm::all(glm::lessThan(box.hi, inside.hi));
  if (!within) touched.push_back(plan.outside());
  return touched;
}

}  // namespace sightline
