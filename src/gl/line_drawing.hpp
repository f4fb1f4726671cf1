// Lines over a drawn scene: boxes, frusta. Tested against the depth of the scene, without ids. Knows no window.
#pragma once

#include <span>
#include <vector>

#include "gl/context.hpp"
#include "gl/handles.hpp"
#include "gl/target.hpp"
#include "sightline/geometry/aabb.hpp"
#include "sightline/scene/view.hpp"

namespace sightline::gl {

/// World space, metres; colour is 0xAABBGGRR.
struct Line {
  glm::dvec3 from, to;
  std::uint32_t colour;
};

/// The twelve edges of a box; those of the part of space that a view sees, up to `far` metres.
void add_box(std::vector<Line>& lines, const Aabb& box, std::uint32_t colour);
void add_frustum(std::vector<Line>& lines, const View& view, double far, std::uint32_t colour);

class LineDrawing {
 public:
  explicit LineDrawing(Context& context);
  /// Draws into the colour of `target`, which holds what SceneDrawing drew from `view`. Leaves OpenGL's state changed.
  void draw(const View& view, std::span<const Line> lines, const Target& target);

 private:
  Program program_;
  VertexArray array_;
  StreamBuffer vertices_;
};

}  // namespace sightline::gl
