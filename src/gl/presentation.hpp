// What a person gets to see of a Target: its colour or its depth, copied into a window or into a canvas without one.
#pragma once

#include <cstdint>
#include <vector>

#include "gl/context.hpp"
#include "gl/handles.hpp"
#include "gl/target.hpp"
#include "sightline/scene/view.hpp"

namespace sightline::gl {

/// A framebuffer of RGBA8 alone, for pictures without a window.
class Canvas {
 public:
  Canvas(int width, int height);
  [[nodiscard]] unsigned framebuffer() const { return framebuffer_.name(); }

 private:
  Texture colour_;
  Framebuffer framebuffer_;
};

/// The pixels of a framebuffer (0: the window), rows from the top, three bytes a pixel. Waits until all is drawn.
std::vector<std::uint8_t> read_rgb(unsigned framebuffer, int width, int height);

class Presentation {
 public:
  explicit Presentation(Context& context);
  /// Copies the colour of `target` to the framebuffer (0: the window), which has the same size and is bound afterwards.
  void show_colour(const Target& target, unsigned framebuffer);
  /// The depth of `target`, drawn from `view`: near is bright, logarithmic between the nearest and the farthest
  /// surface; the background is dark blue.
  void show_depth(const Target& target, const View& view, unsigned framebuffer);

 private:
  Program depth_program_;
  VertexArray no_attributes_;
};

}  // namespace sightline::gl
