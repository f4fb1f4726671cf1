#include "sightline/index/bsp_boolean.hpp"

#include <algorithm>

namespace sightline {
namespace {

/// What lies at the two sides of a piece of surface: its own front and back.
struct Neighbourhood {
  bool front_inside, back_inside;
};

/// A piece on its way down the tree.
struct Piece {
  std::vector<BspCorner> corners;
  std::uint32_t at;       // node or leaf
  std::uint32_t pending;  // where the back of a piece that lies in a plane goes down afterwards; no_pending else
  bool split_sides;       // it lies in a plane that was passed: front and back are looked for one after the other
  bool front_known, front_inside;
};
constexpr std::uint32_t no_pending = 0xFFFFFFFDu;

bool keep_first(const Neighbourhood& n, BooleanOp op) {
  const bool outside = !n.front_inside && !n.back_inside, inside = n.front_inside && n.back_inside;
  const bool same = !n.front_inside && n.back_inside, opposite = n.front_inside && !n.back_inside;
  switch (op) {
    case BooleanOp::unite:
      return outside || same;
    case BooleanOp::intersect:
      return inside || same;
    case BooleanOp::subtract:
      return outside || opposite;
  }
  return false;
}

bool keep_second(const Neighbourhood& n, BooleanOp op) {
  return op == BooleanOp::unite ? !n.front_inside && !n.back_inside : n.front_inside && n.back_inside;
}

/// Cuts a polygon at the planes of the tree until every piece has one neighbourhood; calls found(corners, what).
template <class Found>
void classify(const Bsp& bsp, std::span<const glm::dvec3> polygon, const glm::dvec3& normal, double tolerance,
              Found&& found) {
  std::vector<Piece> stack;
  Piece whole{{}, bsp.nodes.empty() ? bsp_outside : 0u, no_pending, false, false, false};
  for (const glm::dvec3& p : polygon) whole.corners.push_back({p, no_cut});
  stack.push_back(std::move(whole));
  std::vector<BspCorner> front, back;
  while (!stack.empty()) {
    Piece piece = std::move(stack.back());
    stack.pop_back();
    if (is_bsp_leaf(piece.at)) {
      const bool inside = piece.at == bsp_inside;
      if (!piece.split_sides) {
        found(piece.corners, Neighbourhood{inside, inside});
      } else if (piece.front_known) {
        found(piece.corners, Neighbourhood{piece.front_inside, inside});
      } else {
        piece.front_known = true;
        piece.front_inside = inside;
        piece.at = piece.pending;
        stack.push_back(std::move(piece));
      }
      continue;
    }
    const BspNode& node = bsp.nodes[piece.at];
    const BspSide where = split_polygon(piece.corners, node.plane, piece.at, tolerance, front, back);
    if (where == BspSide::both) {
      Piece other = piece;
      piece.corners = front;
      piece.at = node.front;
      other.corners = back;
      other.at = node.back;
      stack.push_back(std::move(other));
      stack.push_back(std::move(piece));
    } else if (where == BspSide::on && !piece.split_sides) {
      const bool along = glm::dot(normal, node.plane.normal) > 0.0;
      piece.split_sides = true;
      piece.at = along ? node.front : node.back;
      piece.pending = along ? node.back : node.front;
      stack.push_back(std::move(piece));
    } else {
      // On a plane a second time means on the same plane up to the tolerance: the side looked for decides.
      const bool along = glm::dot(normal, node.plane.normal) > 0.0;
      const bool to_front = where == BspSide::on ? along != piece.front_known : where == BspSide::front;
      piece.at = to_front ? node.front : node.back;
      stack.push_back(std::move(piece));
    }
  }
}

void add_kept(BooleanResult& result, const PolygonSet& polygons, const Bsp& other, BooleanOp op, bool second) {
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    const BspPlane plane = plane_of(polygons[i]);
    if (plane.normal == glm::dvec3(0.0)) continue;
    classify(other, polygons[i], plane.normal, other.tolerance,
             [&](const std::vector<BspCorner>& corners, const Neighbourhood& n) {
               if (!(second ? keep_second(n, op) : keep_first(n, op))) return;
               std::vector<glm::dvec3> points;
               for (const BspCorner& corner : corners) points.push_back(corner.position);
               if (second && op == BooleanOp::subtract) std::reverse(points.begin(), points.end());
               result.polygons.add(points);
               result.source.push_back(static_cast<std::uint32_t>(i));
               result.from_second.push_back(second ? 1 : 0);
             });
  }
}

}  // namespace

BooleanResult boolean_of(const PolygonSet& a, const PolygonSet& b, BooleanOp op, const BspConfig& config) {
  Bsp tree_a = build_bsp(a, config), tree_b = build_bsp(b, config);
  tree_a.tolerance = tree_b.tolerance = std::max(tree_a.tolerance, tree_b.tolerance);
  BooleanResult result;
  add_kept(result, a, tree_b, op, false);
  add_kept(result, b, tree_a, op, true);
  return result;
}

double enclosed_volume(const PolygonSet& polygons) {
  if (polygons.corners.empty()) return 0.0;
  const glm::dvec3 anchor = polygons.corners[0];
  double six = 0.0;
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    const std::span<const glm::dvec3> p = polygons[i];
    for (std::size_t k = 2; k < p.size(); ++k)
      six += glm::dot(p[0] - anchor, glm::cross(p[k - 1] - anchor, p[k] - anchor));
  }
  return six / 6.0;
}

}  // namespace sightline
