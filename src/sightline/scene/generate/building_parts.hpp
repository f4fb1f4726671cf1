// The meshes of a generated building: walls with openings, slabs, stairs, doors and furniture. All measures of the
// structure are multiples of 1/64 m, so that sums of them are exact in float and neighbours meet without cracks.
#pragma once

#include "sightline/scene/generate/layout.hpp"

namespace sightline {

namespace building {
inline constexpr double storey = 3.0;             // from floor to floor
inline constexpr double slab = 0.25;              // thickness of a floor; its middle is the boundary between storeys
inline constexpr double bay = 5.0;                // width of a room, along x
inline constexpr double depth = 6.0;              // depth of a room, along z
inline constexpr double corridor = 2.5;           // width of a corridor
inline constexpr double ceiling = storey - slab;  // height of free space
}  // namespace building

/// A wall from x = 0 to its width around z = 0; the floor is at y = 0. Openings are where it can be seen through.
struct WallKind {
  Part part;
  std::vector<Opening> openings;
};

/// A piece of furniture that stands on the floor, its back towards -z.
struct Furniture {
  Part part;
  float surface;         // height on which small things can stand
  float half_x, half_z;  // free area of that surface
};

struct BuildingParts {
  explicit BuildingParts(Layout& layout);

  // Of a bay's width, along x.
  std::vector<WallKind> corridor_walls, facades;
  WallKind back, back_door;
  // Of a room's depth, along z.
  WallKind partition, partition_door, end_facade;
  // Of a corridor's width.
  WallKind end_window, end_solid, entrance;
  Part floor_slab;  // box from 0 to 1 in x and z, -slab to 0 in y
  Part stair_slab;  // bay by depth with `stair_opening` left open
  Part stairs;      // in that opening, up to the next storey
  Part ground;      // box from -0.5 to 0.5 in x and z, -1 to 0 in y
  Part door;        // hinge at the origin, leaf along x
  Part pane;        // unit square in x and y from 0 to 1
  Furniture desk, table, cupboard, shelf, bed, sofa, sideboard;
  Part chair, stool, plant, floor_lamp, ceiling_lamp;
  std::vector<Part> things;  // small, for surfaces
  Part tree;
};

/// The hole in stair_slab, x and z measured from the corner of the room.
inline constexpr Opening stair_opening{1.0f, 1.5f, 4.5f, 2.75f};

}  // namespace sightline
