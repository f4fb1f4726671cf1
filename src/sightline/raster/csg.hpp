// Solids combined in the image by the stencil buffer (Goldfeather 1986, Wiegand 1996; checklist 8.07): what is seen of
// A and B, A or B, A without B. Promise: the right surface at every pixel for closed solids that do not cross
// themselves, convex or not, of which the eye is outside and the near plane cuts none, within the depth's resolution.
#pragma once

#include <span>

#include "sightline/raster/pipeline.hpp"

namespace sightline::raster {

enum class Csg { unite, intersect, subtract };

namespace csg_detail {

/// Fragments of a program beyond those that `before` holds. They write the depth that they were compared by.
template <class Program>
struct Beyond {
  static constexpr std::size_t varyings = Program::varyings;
  static constexpr bool discards = true, writes_depth = true;
  const Program& program;
  const Target& before;
  [[nodiscard]] ClipVertex<varyings> vertex(std::uint32_t i) const { return program.vertex(i); }
  bool fragment(const Fragment<varyings>& in, FragmentResult& out) const {
    const std::uint32_t code = depth_code(before.format, static_cast<double>(in.z));
    return code > before.depth[before.index(in.x, in.y)] && program.fragment(in, out);
  }
};

/// Draws into `out` (cleared) what is nearest of the front (or back) faces of `solid` that lie inside (or outside) of
/// `other`. Layer by layer from the front: the nearest one beyond those before (depth peeling, Everitt 2001); then
/// every face of `other` in front of it inverts the stencil, so an odd count is inside.
template <class A, class B>
void part(const A& solid, std::span<const glm::uvec3> triangles, bool front_layers, const B& other,
          std::span<const glm::uvec3> others, bool inside, Target& out, DrawCounts& counts) {
  State surface, parity;
  surface.cull = front_layers ? CullFace::back : CullFace::front;
  parity.depth.mask = false;
  parity.color_mask = {false, false, false, false};
  parity.stencil.enabled = true;
  parity.stencil.front.zpass = parity.stencil.back.zpass = StencilOp::invert;
  const std::uint32_t far = depth_code(out.format, 1.0);
  Target before(out.width, out.height, out.format), layer = before;
  before.clear_depth(State(), 0.0);
  for (;;) {
    layer.clear();
    const std::uint64_t written = counts.depth_writes;
    draw(surface, Beyond<A>{solid, before}, triangles, layer, counts);
    if (counts.depth_writes == written) return;
    draw(parity, other, others, layer, counts);
    for (std::size_t i = 0; i < layer.depth.size(); ++i) {
      before.depth[i] = layer.depth[i];  // far: no layer is left
      if (layer.depth[i] == far || (layer.stencil[i] != 0) != inside) continue;
      out.depth[i] = layer.depth[i];
      out.colour[i] = layer.colour[i];
      before.depth[i] = far;
    }
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
