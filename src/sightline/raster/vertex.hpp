// First stage: what a program's vertex part hands on, and the way from clip space to the window. As in OpenGL the clip
// volume is -w <= x, y, z <= w; the window has y down (row 0 is the top row) and depth 0 (near) to 1 (far).
#pragma once

#include <array>
#include <cstddef>
#include <glm/glm.hpp>

namespace sightline::raster {

/// N varyings are interpolated with perspective correction.
template <std::size_t N>
struct ClipVertex {
  glm::vec4 position{0.0f};
  std::array<float, N> varying{};
};

/// A vertex in the window: x, y in pixels from the top left, z the window depth, w the reciprocal of the clip w.
struct WindowPoint {
  float x, y, z, w;
};

/// Division by w, then the viewport. The order of operations is that of common OpenGL implementations: reciprocal of w
/// first, then one multiplication and addition each; `viewport_transform` states it once for all.
inline WindowPoint viewport_transform(const glm::vec4& clip, int width, int height) {
  const float w = 1.0f / clip.w;
  const float half_width = 0.5f * static_cast<float>(width), half_height = 0.5f * static_cast<float>(height);
  return {clip.x * w * half_width + half_width, clip.y * w * -half_height + half_height, clip.z * w * 0.5f + 0.5f, w};
}

}  // namespace sightline::raster
