// Conditional rendering: the device itself skips what its query found hidden; the processor reads nothing and waits for
// nothing.
#pragma once

#include <memory>

#include "gl/method.hpp"
#include "sightline/core/parameters.hpp"

namespace sightline::gl {

std::unique_ptr<Method> make_conditional(SceneDrawing& drawing, ParameterReader& parameters);

}  // namespace sightline::gl
