// Resolution of the depth buffer (checklist 3.15-3.17): at which distance two planes can no longer be told apart.
#pragma once

#include <cmath>

#include "sightline/raster/target.hpp"

namespace sightline::raster {

/// Window depth of a point at a distance along the view direction, perspective with these planes (E5).
inline double window_depth(double distance, double near, double far) {
  return far / (far - near) * (1.0 - near / distance);
}

/// Distance from which on planes `apart` metres apart fall into one step of the buffer: the step of window depth over
/// its slope far near / ((far - near) d^2). For float32 the step is that of floats from a half to one, 2^-24.
inline double fighting_distance(DepthFormat format, double apart, double near, double far) {
  const int bits = depth_bits(format);
  const double step = bits == 0 ? std::ldexp(1.0, -24) : 1.0 / (std::ldexp(1.0, bits) - 1.0);
  return std::sqrt(apart * far * near / (far - near) / step);
}

}  // namespace sightline::raster
