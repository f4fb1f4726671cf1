// 2.5-D column casting as in Wolfenstein 3D (id Software 1992; Amanatides and Woo 1987 for the walk; checklist
// 13.17-13.19): one ray per image column through a grid map, walls as columns of a texture, floor and ceiling by row.
// Promise: exact: ids and depth are those of the extruded scene, with fisheye correction; without it, they bulge.
#pragma once

#include "sightline/core/counters.hpp"
#include "sightline/core/frame.hpp"
#include "sightline/scene/grid_map.hpp"
#include "sightline/scene/view.hpp"

namespace sightline {

struct ColumnCastConfig {
  /// Wall heights by the distance along the view direction; false takes the distance along the ray, which bends
  /// straight walls (13.18).
  bool correct_fisheye = true;
  bool textured = true;  // false: ids and depth only
};

/// Draws the map: object ids of extrude(), depth along the view direction (what the picture uses as such), colour; the
/// triangle ids stay 0. The eye must lie between floor and ceiling, not within a wall, and look horizontally, upright,
/// in perspective. Throws InputError otherwise. Cells outside of the map are empty and have neither floor nor ceiling.
void column_cast(const GridMap& map, const View& view, const ColumnCastConfig& config, Frame& frame,
                 Counters& counters);

}  // namespace sightline
