// Pictures of what the work was: counts per pixel as heat, and the status of 8 x 8 depth tiles.
#pragma once

#include <cstdint>
#include <span>

#include "picture.hpp"

namespace sightline::cli {

/// Dark blue for 0 over green and yellow to red for `most` and above.
template <class Count>
Picture paint_counts(int width, int height, std::span<const Count> counts, double most);

/// The mean and the largest count are in the eye of the reader: 0 to this is a scale that suits both.
inline constexpr double most_layers_shown = 10.0;

/// How the hierarchical z-buffer's memory would hold the frame's depth as unorm24: cleared tiles dark, compressed ones
/// green (the smaller, the brighter), uncompressed ones red.
Picture paint_tiles(const View& view, const Frame& frame);

}  // namespace sightline::cli
