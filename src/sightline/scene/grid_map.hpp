// A map of square cells, full or empty, with a flat floor and ceiling: the 2.5-D world of Wolfenstein 3D (1992;
// checklist 13.17), a generator of mazes, and the bridge to a Scene, by which the column caster is checked.
#pragma once

#include <cstdint>
#include <vector>

#include "sightline/scene/scene.hpp"

namespace sightline {

/// Cell (x, z) fills [x, x + 1] * cell in x and [z, z + 1] * cell in z; the floor lies at y = 0.
struct GridMap {
  int width = 0, depth = 0;         // cells along x and z
  float cell = 1.0f;                // metres
  float height = 1.0f;              // of walls and ceiling, metres
  std::vector<std::uint8_t> walls;  // width * depth, row z after row z; 0 is empty, else the number of a texture

  [[nodiscard]] std::size_t index(int x, int z) const {
    return static_cast<std::size_t>(z) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
  /// 0 outside of the map.
  [[nodiscard]] std::uint8_t at(int x, int z) const {
    return x < 0 || z < 0 || x >= width || z >= depth ? std::uint8_t{0} : walls[index(x, z)];
  }
};

/// Throws InputError unless sizes are in [1, 4096], cell and height above 0, and walls has width * depth entries.
void check_grid_map(const GridMap& map);

/// A maze of width x depth cells (odd, at least 5; even numbers are rounded down) in which every empty cell can be
/// reached, by depth-first search with a seed; `loops` of the inner walls (a share, 0 to 1) are taken out again.
GridMap make_maze(int width, int depth, std::uint64_t seed, double loops = 0.1);

/// Every full cell as a box, in the order of the cells, then the floor and the ceiling as two triangles each: the id of
/// the k-th full cell is k, then come floor and ceiling.
Scene extrude(const GridMap& map);

/// The object of extrude() for every cell; no_object where the cell is empty.
std::vector<ObjectId> wall_objects(const GridMap& map);

}  // namespace sightline
