// Resolution of the depth buffer (checklist 3.15-3.17): at which distance two planes can no longer be told apart, as
// the slope of the window depth predicts it and as drawing shows it; and beside it what eyes tell apart (1.21).
#pragma once

#include <cmath>

#include "sightline/raster/target.hpp"

namespace sightline::raster {

/// Window depth of a point at a distance along the view direction, perspective with these planes (E5).
inline double window_depth(double distance, double near, double far) {
  return far / (far - near) * (1.0 - near / distance);
}

/// One step of the buffer in window depth. For float32 that of floats from a half to one, 2^-24.
inline double depth_step(DepthFormat format) {
  const int bits = depth_bits(format);
  return bits == 0 ? std::ldexp(1.0, -24) : 1.0 / (std::ldexp(1.0, bits) - 1.0);
}

/// One step of the buffer in metres at a distance: step over the slope far near / ((far - near) d^2) of the window
/// depth.
inline double depth_step_at(DepthFormat format, double distance, double near, double far) {
  return depth_step(format) * distance * distance * (far - near) / (far * near);
}

/// Distance from which on planes `apart` metres apart fall into one step of the buffer.
inline double fighting_distance(DepthFormat format, double apart, double near, double far) {
  return std::sqrt(apart * far * near / (far - near) / depth_step(format));
}

/// Draws a plane and, `apart` metres before it and after it in time, another (LESS), both slanted from 0.99 to 1.01 of
/// the distance: the share of pixels at which the nearer one is lost.
double fighting_share(DepthFormat format, double distance, double apart, double near, double far);

/// Smallest difference of depth, metres, that two eyes `baseline` metres apart with an acuity in radians can tell: as
/// for the depth buffer it grows with the square of the distance. The default acuity is 20 seconds of arc.
inline double stereo_threshold(double distance, double baseline = 0.065, double acuity = 9.7e-5) {
  return distance * distance * acuity / baseline;
}
/// Shares of the distance that Cutting and Vishton (1995) give as just noticeable at any distance: by occlusion, which
/// asks for no more than an edge, and by relative size.
inline constexpr double occlusion_threshold = 0.001, relative_size_threshold = 0.03;

}  // namespace sightline::raster
