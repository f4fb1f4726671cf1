// The two ends between which every other method lies: gl_frustum draws all that the frustum holds, gl_optimal exactly
// what is seen. Neither asks anything.
#pragma once

#include <memory>

#include "gl/method.hpp"
#include "sightline/core/parameters.hpp"

namespace sightline::gl {

std::unique_ptr<Method> make_frustum(SceneDrawing& drawing, ParameterReader& parameters);
std::unique_ptr<Method> make_optimal(SceneDrawing& drawing, ParameterReader& parameters);

}  // namespace sightline::gl
