// Frames as pictures a person can look at.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sightline/core/frame.hpp"
#include "sightline/scene/view.hpp"

namespace sightline::cli {

/// What of a frame a picture shows.
enum class Show {
  shaded,    // lit from the eye and from above
  normal,    // the world-space normal that faces the eye, as red, green, blue
  object,    // one colour for each object
  depth,     // near is bright, logarithmic between the nearest and the farthest surface
  overdraw,  // how often each pixel was written; needs Frame::writes
  tiles,     // how the 8 x 8 depth tiles would lie in the memory of a hierarchical z-buffer
  stencil    // the stencil buffer as heat; needs Frame::stencil
};

/// Rows from the top, three bytes a pixel.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

/// `frame` must have been drawn of `scene` from `view`.
Picture paint(const Scene& scene, const View& view, const Frame& frame, Show show);

/// A heat map of how many surfaces lie over each pixel (Oracle::count_surfaces; rows from the top): black for none,
/// dark blue for one, then by doublings over green, yellow and red to white for 32 and more.
Picture paint_overdraw(int width, int height, const std::vector<std::uint8_t>& surfaces);

/// The bytes of a PNG file.
std::string encode_png(const Picture& picture);

}  // namespace sightline::cli
