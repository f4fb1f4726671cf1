// The test that counts: is the picture of a method, bit by bit, that of drawing everything?
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gl/method.hpp"

namespace sightline::gl {

/// Draws pictures to compare: ties in depth are resolved by id, so that the order of drawing cannot be seen.
class Comparison {
 public:
  explicit Comparison(SceneDrawing& drawing) : drawing_(drawing) {}

  /// The reference for `view`: every object that the scene holds, no culling at all unless `in_frustum`.
  void draw_all(const View& view, bool in_frustum = false);
  /// Draws a frame by `method` and counts the pixels that differ from the reference in colour, depth or id. Also keeps
  /// what was drawn.
  std::uint64_t differing_pixels(Method& method, const View& view);
  [[nodiscard]] const Frame& reference() const { return reference_; }
  [[nodiscard]] const Frame& picture() const { return picture_; }

 private:
  SceneDrawing& drawing_;
  Target target_;
  Frame reference_, picture_;
  std::vector<ObjectId> drawn_;
};

}  // namespace sightline::gl
