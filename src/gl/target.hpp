// What is drawn into: colour, object id and depth at pixel centres, and how they come back as a Frame.
#pragma once

#include "gl/handles.hpp"
#include "sightline/core/frame.hpp"
#include "sightline/scene/view.hpp"

namespace sightline::gl {

/// Framebuffer with RGBA8 colour, 32-bit object id and 32-bit float depth. Depth runs from 1 at the near plane to 0 at
/// the far plane: near is large (reversed), so that a float keeps its precision far away.
class Target {
 public:
  Target() = default;
  /// Makes room for width x height pixels; does nothing if it has that size already. Throws Unavailable.
  void resize(int width, int height);
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] unsigned framebuffer() const { return framebuffer_.name(); }
  [[nodiscard]] unsigned depth_texture() const { return depth_.name(); }
  [[nodiscard]] unsigned colour_texture() const { return colour_.name(); }

  /// The picture as a Frame: colour, object, and depth in metres along the view direction, row 0 on top; the triangle
  /// plane is 0. `view` must be the one that was drawn. Waits until all is drawn.
  void read_back(const View& view, Frame& frame) const;
  /// Object ids alone, rows from the bottom.
  void read_ids(std::vector<std::uint32_t>& ids) const;

 private:
  int width_ = 0, height_ = 0;
  Texture colour_, id_, depth_;
  Framebuffer framebuffer_;
};

}  // namespace sightline::gl
