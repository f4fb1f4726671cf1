// The one image type. Row 0 is the top row; every plane has width * height entries, colour and the planes after it may
// be empty.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "sightline/scene/scene.hpp"

namespace sightline {

struct Frame {
  int width = 0, height = 0;
  /// Distance along the view direction in metres (view space -z); infinity is the background. Near is small.
  std::vector<float> depth;
  /// The object nearest at the pixel centre, or no_object.
  std::vector<ObjectId> object;
  /// Triangle within the object's mesh; undefined where there is no object.
  std::vector<std::uint32_t> triangle;
  /// 0xAABBGGRR (bytes r, g, b, a in memory). Empty where the renderer does not shade.
  std::vector<std::uint32_t> colour;
  /// Empty where the renderer has no stencil buffer.
  std::vector<std::uint8_t> stencil;
  /// How often each pixel was written (checklist 6.07). Empty unless the renderer was asked to count.
  std::vector<std::uint32_t> writes;

  /// Sets the size and clears to the background.
  void clear(int new_width, int new_height) {
    width = new_width;
    height = new_height;
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    depth.assign(pixels, std::numeric_limits<float>::infinity());
    object.assign(pixels, no_object);
    triangle.assign(pixels, 0);
    colour.clear();
    stencil.clear();
    writes.clear();
  }
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
};

}  // namespace sightline
