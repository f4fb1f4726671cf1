// The meshes of a generated plant: steel, pipes, tanks and what is fixed to them. Metres.
#pragma once

#include "sightline/scene/generate/layout.hpp"

namespace sightline {

struct PlantParts {
  explicit PlantParts(Layout& layout);

  Part ground;              // box from -0.5 to 0.5 in x and z, -1 to 0 in y
  Part girder;              // I-section 0.3 high, along x from 0 to 1
  Part column;              // I-section 0.3 deep, along y from 0 to 1
  Part pipe;                // radius 1, along x from 0 to 1
  Part flange;              // for a pipe of radius 1 around the x axis
  Part valve;               // likewise, with a hand wheel upwards
  std::vector<Part> bends;  // pipes of radius 0.1 with several bends, about 3 metres long, from the origin
  Part tank;                // upright, radius 1 and height 1, domed roof
  Part sphere;              // radius 1 on legs, standing on y = 0
  Part vessel;              // lying along x, radius 1, from -2.5 to 2.5, on saddles that stand on y = 0
  Part reactor;             // upright vessel on a skirt, radius 1, height 6
  Part ladder;              // 3 metres high, against the plane z = 0
  Part platform;            // box from 0 to 1 in x and z, -0.08 to 0 in y
  Part grating;             // bars instead, 1 by 1
  Part handrail;            // along x from 0 to 3
  Part pump, lamp, cabinet;
  Part tray;  // U-section 0.4 wide, along x from 0 to 1
  Part dike;  // box from 0 to 1 in x, 1 high, 0.3 thick
};

}  // namespace sightline
