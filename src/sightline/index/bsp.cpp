#include "sightline/index/bsp.hpp"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

bool lexicographically_less(const glm::dvec3& a, const glm::dvec3& b) {
  if (a.x != b.x) return a.x < b.x;
  if (a.y != b.y) return a.y < b.y;
  return a.z < b.z;
}

/// The point of the edge on the plane, computed from the same end whichever way the edge is run, so that neighbours
/// agree bit by bit.
glm::dvec3 crossing(const glm::dvec3& a, double fa, const glm::dvec3& b, double fb) {
  const bool swap = lexicographically_less(b, a);
  const glm::dvec3 &p = swap ? b : a, &r = swap ? a : b;
  const double fp = swap ? fb : fa, fr = swap ? fa : fb;
  return p + (-fp / (fr - fp)) * (r - p);
}

int side(double f, double tolerance) { return f > tolerance ? 1 : f < -tolerance ? -1 : 0; }

/// The parameters t in [t0, t1] for which offset + t * slope >= 0.
void clip_interval(double offset, double slope, double& t0, double& t1) {
  if (slope > 0.0)
    t0 = std::max(t0, -offset / slope);
  else if (slope < 0.0)
    t1 = std::min(t1, -offset / slope);
  else if (offset < 0.0)
    t1 = -1.0;
}

/// A segment in the plane of a convex polygon: clipped by the polygon's edges.
bool in_plane_segment_meets(const glm::dvec3& from, const glm::dvec3& to, std::span<const glm::dvec3> polygon,
                            const BspPlane& plane, double tolerance, double& t) {
  double t0 = 0.0, t1 = 1.0;
  for (std::size_t i = 0; i < polygon.size() && t0 <= t1; ++i) {
    const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const glm::dvec3 inward = glm::cross(plane.normal, b - a);
    const double length = glm::length(inward);
    if (!(length > 0.0)) continue;
    const double fa = glm::dot(inward, from - a) / length + tolerance,
                 fb = glm::dot(inward, to - a) / length + tolerance;
    clip_interval(fa, fb - fa, t0, t1);
  }
  if (t0 > t1) return false;
  t = t0;
  return true;
}

bool inside_polygon(const glm::dvec3& p, std::span<const glm::dvec3> polygon, const BspPlane& plane, double tolerance) {
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const glm::dvec3 inward = glm::cross(plane.normal, b - a);
    if (glm::dot(inward, p - a) < -tolerance * glm::length(inward)) return false;
  }
  return true;
}

}  // namespace

BspPlane plane_of(std::span<const glm::dvec3> polygon) {
  BspPlane plane;
  if (polygon.size() < 3) return plane;
  const glm::dvec3 anchor = polygon[0];
  glm::dvec3 normal(0.0), centre(0.0);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 a = polygon[i] - anchor, b = polygon[(i + 1) % polygon.size()] - anchor;
    normal += glm::cross(a, b);
    centre += a;
  }
  const double largest = std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)});
  if (!(largest > 0.0) || !std::isfinite(largest)) return plane;
  plane.normal = glm::normalize(normal / largest);
  centre = anchor + centre / static_cast<double>(polygon.size());
  plane.offset = -glm::dot(plane.normal, centre);
  return plane;
}

BspSide split_polygon(std::span<const BspCorner> polygon, const BspPlane& plane, std::uint32_t node, double tolerance,
                      std::vector<BspCorner>& front, std::vector<BspCorner>& back) {
  const std::uint32_t cut_front = 2 * node, cut_back = 2 * node + 1;
  front.clear();
  back.clear();
  bool any_front = false, any_back = false;
  for (const BspCorner& corner : polygon) {
    const int s = side(plane.at(corner.position), tolerance);
    any_front |= s > 0;
    any_back |= s < 0;
  }
  if (!any_front || !any_back) return any_front ? BspSide::front : any_back ? BspSide::back : BspSide::on;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const BspCorner &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double fa = plane.at(a.position), fb = plane.at(b.position);
    const int sa = side(fa, tolerance), sb = side(fb, tolerance);
    // A part leaves the boundary where the next corner lies on the other side: from there on it follows the cut.
    if (sa >= 0) front.push_back({a.position, sa == 0 && sb < 0 ? cut_front : a.cut});
    if (sa <= 0) back.push_back({a.position, sa == 0 && sb > 0 ? cut_back : a.cut});
    if (sa * sb >= 0) continue;
    const glm::dvec3 x = crossing(a.position, fa, b.position, fb);
    front.push_back({x, sa > 0 ? cut_front : a.cut});
    back.push_back({x, sa < 0 ? cut_back : a.cut});
  }
  return BspSide::both;
}

bool is_inside(const Bsp& bsp, const glm::dvec3& p) {
  std::uint32_t at = bsp.nodes.empty() ? bsp_outside : 0;
  while (!is_bsp_leaf(at)) at = bsp.nodes[at].plane.at(p) > 0.0 ? bsp.nodes[at].front : bsp.nodes[at].back;
  return at == bsp_inside;
}

bool segment_meets_polygon(const glm::dvec3& from, const glm::dvec3& to, std::span<const glm::dvec3> polygon,
                           const BspPlane& plane, double tolerance, double& t) {
  const double fa = plane.at(from), fb = plane.at(to);
  const int sa = side(fa, tolerance), sb = side(fb, tolerance);
  if (sa * sb > 0) return false;
  if (sa == 0 && sb == 0) return in_plane_segment_meets(from, to, polygon, plane, tolerance, t);
  const double crossing_t = sa == 0 ? 0.0 : sb == 0 ? 1.0 : fa / (fa - fb);
  if (!inside_polygon(from + crossing_t * (to - from), polygon, plane, tolerance)) return false;
  t = crossing_t;
  return true;
}

bool first_hit(const Bsp& bsp, const glm::dvec3& from, const glm::dvec3& to, BspHit& hit) {
  struct Piece {
    std::uint32_t node;
    double t0, t1;
  };
  const double length = glm::length(to - from);
  const double slack = 4.0 * bsp.tolerance;
  bool found = false;
  std::vector<Piece> stack;
  if (!bsp.nodes.empty()) stack.push_back({0, 0.0, 1.0});
  while (!stack.empty()) {
    const Piece piece = stack.back();
    stack.pop_back();
    if (found && piece.t0 > hit.t) continue;
    const BspNode& node = bsp.nodes[piece.node];
    const double f0 = node.plane.at(from), slope = node.plane.at(to) - f0;
    const double fa = f0 + piece.t0 * slope, fb = f0 + piece.t1 * slope;
    // A piece that comes as close as the tolerance allows touches the plane.
    const bool near_front = fa >= -slack || fb >= -slack, near_back = fa <= slack || fb <= slack;
    if (near_front && near_back)
      for (const BspFragment& fragment : bsp.fragments_of(node)) {
        // The whole source: a hit on it is a hit, and no gap between fragments can be slipped through.
        const std::span<const glm::dvec3> polygon = bsp.polygons[fragment.source];
        double t = 0.0;
        if (!segment_meets_polygon(from, to, polygon, bsp.planes[fragment.source], bsp.tolerance, t)) continue;
        if (found && (t > hit.t || (t == hit.t && fragment.source >= hit.source))) continue;
        hit = {t, fragment.source};
        found = true;
      }
    // The parts of the segment in either half-space, a little more than half-open; near part on top of the stack.
    const auto part = [&](bool front) {
      const std::uint32_t child = front ? node.front : node.back;
      if (is_bsp_leaf(child) || !(front ? near_front : near_back)) return;
      double t0 = piece.t0, t1 = piece.t1;
      const double sign = front ? 1.0 : -1.0;
      clip_interval(sign * f0 + 2.0 * slack, sign * slope, t0, t1);
      const double margin = length > 0.0 ? slack / length : 0.0;
      t0 = std::max(piece.t0, t0 - margin);
      t1 = std::min(piece.t1, t1 + margin);
      if (t0 <= t1) stack.push_back({child, t0, t1});
    };
    const bool starts_in_front = fa > fb ? true : fa < fb ? false : fa >= 0.0;
    part(!starts_in_front);
    part(starts_in_front);
  }
  return found;
}

}  // namespace sightline
