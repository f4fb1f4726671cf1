// Solids combined in the image by the stencil buffer (Goldfeather 1986, Wiegand 1996; checklist 8.07): what is seen of
// A and B, A or B, A without B. Promise: the right surface at every pixel for closed solids of which the eye is outside
// and each of which has at most one front and one back layer per pixel (convex ones), within the depth's resolution.
#pragma once

#include <span>

#include "sightline/raster/pipeline.hpp"

namespace sightline::raster {

enum class Csg { unite, intersect, subtract };

namespace csg_detail {

/// Draws the layer of `solid` that faces as `keep`, then keeps it only where it lies inside (or outside) of `other`:
/// every face of `other` in front of it inverts the stencil, so an odd count is inside. Else the pixel is cleared.
template <class A, class B>
void part(const A& solid, std::span<const glm::uvec3> triangles, bool front_layer, const B& other,
          std::span<const glm::uvec3> others, bool inside, Target& out, DrawCounts& counts) {
  State surface;
  surface.cull = front_layer ? CullFace::back : CullFace::front;
  draw(surface, solid, triangles, out, counts);
  State parity;
  parity.depth.mask = false;
  parity.color_mask = {false, false, false, false};
  parity.stencil.enabled = true;
  parity.stencil.front.zpass = parity.stencil.back.zpass = StencilOp::invert;
  draw(parity, other, others, out, counts);
  const std::uint32_t far = depth_code(out.format, 1.0);
  for (std::size_t i = 0; i < out.depth.size(); ++i) {
    if ((out.stencil[i] != 0) == inside) continue;
    out.depth[i] = far;
    out.colour[i] = 0;
  }
}

}  // namespace csg_detail

/// Draws the combination of two solids, given by programs and triangles, into a cleared target of any format.
template <class A, class B>
void draw_csg(Csg operation, const A& a, std::span<const glm::uvec3> a_triangles, const B& b,
              std::span<const glm::uvec3> b_triangles, Target& target, DrawCounts& counts) {
  if (operation == Csg::unite) {
    draw(State(), a, a_triangles, target, counts);
    draw(State(), b, b_triangles, target, counts);
    return;
  }
  const bool both = operation == Csg::intersect;
  Target one(target.width, target.height, target.format), two(target.width, target.height, target.format);
  csg_detail::part(a, a_triangles, true, b, b_triangles, both, one, counts);
  // A without B shows the far walls of B where they lie inside of A.
  csg_detail::part(b, b_triangles, both, a, a_triangles, true, two, counts);
  for (std::size_t i = 0; i < target.depth.size(); ++i) {
    const Target& from = two.depth[i] < one.depth[i] ? two : one;
    if (from.depth[i] >= target.depth[i]) continue;
    target.depth[i] = from.depth[i];
    target.colour[i] = from.colour[i];
  }
}

}  // namespace sightline::raster
