// Where the rooms of a generated building lie: the plan, its cells, and which objects touch which cell.
#pragma once

#include "sightline/scene/generate/building_parts.hpp"

namespace sightline {

/// Per storey: a cross corridor along z at x < 0, and `rows` corridors along x with `bays` rooms on either side.
struct BuildingPlan {
  std::uint32_t storeys = 1, rows = 1, bays = 1;

  static constexpr double row_pitch = 2 * building::depth + building::corridor;
  [[nodiscard]] double length_x() const { return bays * building::bay; }
  [[nodiscard]] double length_z() const { return rows * row_pitch; }
  /// Lowest z of a room (side 0 or 1) and of the corridor between both.
  static double room_z(std::uint32_t row, std::uint32_t side) {
    return row * row_pitch + (side == 0 ? 0.0 : building::depth + building::corridor);
  }
  static double corridor_z(std::uint32_t row) { return row * row_pitch + building::depth; }

  // Cells, storey by storey: rooms, corridors, the cross corridor; the outside comes last.
  [[nodiscard]] std::uint32_t cells_per_storey() const { return rows * (2 * bays + 1) + 1; }
  [[nodiscard]] std::uint32_t room(std::uint32_t storey, std::uint32_t row, std::uint32_t side,
                                   std::uint32_t bay) const {
    return storey * cells_per_storey() + (row * 2 + side) * bays + bay;
  }
  [[nodiscard]] std::uint32_t corridor(std::uint32_t storey, std::uint32_t row) const {
    return storey * cells_per_storey() + rows * 2 * bays + row;
  }
  [[nodiscard]] std::uint32_t cross_corridor(std::uint32_t storey) const {
    return (storey + 1) * cells_per_storey() - 1;
  }
  [[nodiscard]] std::uint32_t outside() const { return storeys * cells_per_storey(); }
  /// The room that holds the stairs of a storey.
  [[nodiscard]] std::uint32_t stair_room(std::uint32_t storey) const { return room(storey, 0, 1, bays - 1); }
  /// What all cells but the outside fill.
  [[nodiscard]] Aabb interior() const;
};

/// A plan with about so many rooms.
BuildingPlan plan_building(std::uint32_t rooms);

/// The cells of a plan, without objects; bounds meet in the middle of walls and slabs. The bounds of the outside are
/// empty.
std::vector<Cell> building_cells(const BuildingPlan& plan);

/// All cells but the outside whose closed bounds meet `box`; and the outside if `box` is not inside the interior.
std::vector<std::uint32_t> cells_touching(const BuildingPlan& plan, const std::vector<Cell>& cells, const Aabb& box);

}  // namespace sightline
