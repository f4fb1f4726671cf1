// Painter's algorithm by sorting triangles along the view direction (checklist 2.01-2.04, E1). Promise: approximate: a
// pixel may show a surface that a nearer one hides, where the sort key misleads; with split=on, which cuts triangles
// whose depth intervals overlap (2.02), as exact as painter_bsp.
#pragma once

#include <memory>

#include "sightline/core/algorithm.hpp"

namespace sightline {

std::unique_ptr<Renderer> make_painter(const IndexedScene& scene, ParameterReader& parameters);

}  // namespace sightline
