// Methods that query objects one by one or in bundles, without a hierarchy and without memory (checklist 22.05, 22.06,
// 22.09, 22.11). What is drawn later may only be asked about against what was drawn before it.
#pragma once

#include <memory>

#include "gl/method.hpp"
#include "sightline/core/parameters.hpp"

namespace sightline::gl {

std::unique_ptr<Method> make_stop_and_wait(SceneDrawing& drawing, ParameterReader& parameters);
std::unique_ptr<Method> make_draw_and_wait(SceneDrawing& drawing, ParameterReader& parameters);
std::unique_ptr<Method> make_multiple_queries(SceneDrawing& drawing, ParameterReader& parameters);
std::unique_ptr<Method> make_overlap_free(SceneDrawing& drawing, ParameterReader& parameters);

}  // namespace sightline::gl
