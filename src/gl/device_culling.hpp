// Culling on the device (two-phase: Haar and Aaltonen 2015; box rasterisation: Boudier and Kubisch 2013): draw what was
// seen in the last frame, test everything against that depth, draw what came into sight. Tests, visibility and draw
// commands stay on the device; the processor issues the same few commands whatever is seen, and reads nothing back
// within a frame.
#pragma once

#include <memory>

#include "gl/method.hpp"
#include "sightline/core/parameters.hpp"

namespace sightline::gl {

/// Tests boxes against a pyramid of farthest depths (Greene 1993), built in compute shaders.
std::unique_ptr<Method> make_hzb(SceneDrawing& drawing, ParameterReader& parameters);
/// Draws boxes whose fragments write "seen" into a buffer.
std::unique_ptr<Method> make_raster(SceneDrawing& drawing, ParameterReader& parameters);

}  // namespace sightline::gl
