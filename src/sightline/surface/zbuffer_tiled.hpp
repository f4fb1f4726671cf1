// The fast renderers on the tile rasteriser: the plain z-buffer, and the hierarchical one (Greene 1993; checklist 5).
// Promise: exact up to the stated depth error; ties of depth go to the lower object, then the lower triangle.
#pragma once

#include <memory>

#include "sightline/core/algorithm.hpp"

namespace sightline {

std::unique_ptr<Renderer> make_zbuffer_tiled(const IndexedScene& scene, ParameterReader& parameters);
std::unique_ptr<Renderer> make_hzb(const IndexedScene& scene, ParameterReader& parameters);

}  // namespace sightline
