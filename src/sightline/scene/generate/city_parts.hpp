// The meshes of a generated city. Buildings have footprint 1 x 1 (x, z from -0.5 to 0.5) and height 1; things stand at
// the origin in metres, their front towards +z.
#pragma once

#include "sightline/scene/generate/layout.hpp"

namespace sightline {

struct CityParts {
  explicit CityParts(Layout& layout);

  Part ground, pavement;     // boxes from -0.5 to 0.5 in x and z, -1 to 0 in y
  std::vector<Part> blocks;  // flat roofs with parapets
  std::vector<Part> towers;  // with setbacks
  std::vector<Part> houses;  // pitched roofs, the ridge along x
  Part street_tree, lamp, car, van, bench, bin, shelter, planter;
  Part garden_tree, shed, hedge;
  Part chimney, rooftop_unit, water_tank, mast;
};

/// The height of the flat roof of `blocks` and of the towers' top, as a share of the building's height.
inline constexpr double city_roof = 0.96875;

}  // namespace sightline
