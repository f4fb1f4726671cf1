// Coherent hierarchical culling (Bittner, Wimmer, Piringer and Purgathofer 2004; checklist 22.20, 22.21, E47).
#pragma once

#include <memory>

#include "gl/method.hpp"
#include "sightline/core/parameters.hpp"

namespace sightline::gl {

std::unique_ptr<Method> make_chc(SceneDrawing& drawing, ParameterReader& parameters);

}  // namespace sightline::gl
