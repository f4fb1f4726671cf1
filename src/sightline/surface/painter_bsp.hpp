// Painter's algorithm in the order of a BSP tree (Fuchs, Kedem and Naylor 1980; checklist 2.21, 15.01-15.16): every
// triangle of the scene is put into one tree, which any eye then walks from far to near. Promise: exact; cyclic overlap
// and penetration are cut apart by the tree.
#pragma once

#include <memory>

#include "sightline/core/algorithm.hpp"

namespace sightline {

std::unique_ptr<Renderer> make_painter_bsp(const IndexedScene& scene, ParameterReader& parameters);

}  // namespace sightline
