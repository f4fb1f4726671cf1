// Puts furniture into the rooms of a generated building.
#pragma once

#include "sightline/scene/generate/building_rooms.hpp"

namespace sightline {

/// Places what the layout still lacks, spread over rooms and corridors, a little of it outside.
void furnish_building(Layout& layout, const BuildingParts& parts, const BuildingPlan& plan, std::uint64_t seed);

}  // namespace sightline
