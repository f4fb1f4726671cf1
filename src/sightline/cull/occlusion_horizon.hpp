// The occlusion horizon for cities (checklist 21.03): objects front to back against a line of slopes over plan
// directions, below which all is hidden; what is culled is dropped, what is not adds its walls. Promise:
// conservative-continuous on any scene, since only walls proven upright and solid are added, as intervals that need not
// reach the ground. Views without a horizon (straight down) get frustum culling.
#pragma once

#include <memory>

#include "sightline/core/algorithm.hpp"

namespace sightline {

/// Parameters: `columns`: of the horizon, 16 to 16384; `occluders`: "walls", or "boxes", the slides' shortcut that
/// takes the bounding box of every object for solid and is approximate; `tight`: sigma of tight occludee bounds
/// (scene/occludee_bounds), 1 to 100.
std::unique_ptr<Culler> make_occlusion_horizon(const IndexedScene& scene, ParameterReader& parameters);

}  // namespace sightline
