// Pictures of what stencil buffer and blending are for, drawn by the software pipeline (checklist 7, 8): small scenes
// of their own, several panels in one picture.
#pragma once

#include <utility>
#include <vector>

#include "picture.hpp"

namespace sightline::cli {

/// Names (without extension) and pictures: stencil_mask, csg, dissolve, two_sided, blending_orders, colour_filters,
/// glass.
std::vector<std::pair<const char*, Picture>> raster_pictures();

}  // namespace sightline::cli
