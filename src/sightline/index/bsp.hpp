// Binary space partition of polygons (Schumacker 1969; Fuchs, Kedem and Naylor 1980; checklist 15.01-15.12, E27-E30):
// plain data, a builder, and walks as free functions. Promise: the fragments of a polygon cover it, keep its
// orientation, and lie on the side of every node's plane that the tree says, up to `tolerance`. Nothing here recurses.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

namespace sightline {

/// F(p) = dot(normal, p) + offset; the normal has unit length. Front is F > 0.
struct BspPlane {
  glm::dvec3 normal{0.0};
  double offset = 0.0;
  [[nodiscard]] double at(const glm::dvec3& p) const { return glm::dot(normal, p) + offset; }
  /// The same for a homogeneous point: w = 1 a point, w = 0 a direction to a point at infinity.
  [[nodiscard]] double at(const glm::dvec4& p) const { return glm::dot(normal, glm::dvec3(p)) + offset * p.w; }
};

/// Convex planar polygons, counter-clockwise seen from the front: polygon i has corners [ends[i - 1], ends[i]).
struct PolygonSet {
  std::vector<glm::dvec3> corners;
  std::vector<std::uint32_t> ends;

  void add(std::span<const glm::dvec3> polygon) {
    corners.insert(corners.end(), polygon.begin(), polygon.end());
    ends.push_back(static_cast<std::uint32_t>(corners.size()));
  }
  [[nodiscard]] std::size_t size() const { return ends.size(); }
  [[nodiscard]] std::span<const glm::dvec3> operator[](std::size_t i) const {
    const std::uint32_t begin = i == 0 ? 0 : ends[i - 1];
    return std::span(corners).subspan(begin, ends[i] - begin);
  }
};

/// The plane of a polygon by Newell's method; its normal is zero for a polygon without area.
BspPlane plane_of(std::span<const glm::dvec3> polygon);

struct BspCorner {
  glm::dvec3 position{0.0};
  /// no_cut if the edge to the next corner lies on an edge of the source polygon; else the cut that made it: 2 * node
  /// for the part in front of that node's plane, 2 * node + 1 for the part behind it.
  std::uint32_t cut = 0xFFFFFFFFu;
};
inline constexpr std::uint32_t no_cut = 0xFFFFFFFFu;

/// What is left of a source polygon in one place of the tree; convex, in the source's sense of rotation.
struct BspFragment {
  std::uint32_t first = 0, count = 0;  // corners
  std::uint32_t source = 0;            // index of the polygon that it is a part of
  bool along = true;                   // its normal points to the front of its node's plane
};

/// Instead of a node below: a leaf. What a leaf is follows from the facing of the polygons at its plane, and means
/// something if the polygons bound a closed solid with outward normals.
inline constexpr std::uint32_t bsp_outside = 0xFFFFFFFFu, bsp_inside = 0xFFFFFFFEu;
inline bool is_bsp_leaf(std::uint32_t child) { return child >= bsp_inside; }

struct BspNode {
  BspPlane plane;
  std::uint32_t front = bsp_outside, back = bsp_inside;  // nodes, or leaves
  std::uint32_t first = 0, count = 0;  // fragments in the plane, of both facings, by ascending source (15.04)
};

struct Bsp {
  std::vector<BspNode> nodes;  // nodes[0] is the root; empty if there are no polygons
  std::vector<BspFragment> fragments;
  std::vector<BspCorner> corners;
  PolygonSet polygons;           // the sources
  std::vector<BspPlane> planes;  // of the sources
  double tolerance = 0.0;        // metres: points closer to a plane lie on it
  std::size_t dropped = 0;       // polygons without area, which are in no node
  std::size_t depth = 0;         // nodes on the longest way down

  [[nodiscard]] std::span<const BspCorner> corners_of(const BspFragment& fragment) const {
    return std::span(corners).subspan(fragment.first, fragment.count);
  }
  [[nodiscard]] std::span<const BspFragment> fragments_of(const BspNode& node) const {
    return std::span(fragments).subspan(node.first, node.count);
  }
};

/// How the plane of a node is chosen.
enum class BspSplitter {
  first,          // the plane of the first polygon that is left: the order of the input decides
  random,         // of a random polygon (15.04)
  fewest_splits,  // of several random polygons the one that cuts fewest
  balance,        // of several random polygons the one that parts the others most evenly
  mixed,          // weighs cuts and balance; tries axis-aligned planes through the median, too
  pca             // through the mean, across the first principal axis, while many polygons are left (15.17; a
                  // heuristic, E32), then as mixed
};

/// By name, as a person types it; false for an unknown one.
inline constexpr std::string_view bsp_splitter_names = "first, random, fewest_splits, balance, mixed or pca";
bool read_splitter(std::string_view name, BspSplitter& splitter);

struct BspConfig {
  BspSplitter splitter = BspSplitter::mixed;
  std::uint64_t seed = 1;
  int candidates = 8;                       // polygons tried for each node, 1 to 64
  double split_weight = 4.0;                // mixed: a cut polygon costs as much as so many of imbalance, >= 0
  std::uint32_t free_planes_above = 24;     // mixed, pca: planes of no polygon only where more polygons are left
  double relative_tolerance = 1e-12;        // of the largest coordinate, 1e-14 to 1e-3
  std::size_t most_fragments = 20'000'000;  // more throw
  /// If set, told now and then which share of the work is done, 0 to 1 (a guess, but it only grows); false gives it up.
  std::function<bool(double)> go_on;
};

/// Builds the tree. Deterministic; O(n log n) where planes part evenly, O(n^2) nodes' work on convex surfaces if only
/// planes of polygons are used. Throws std::length_error beyond most_fragments or if given up. Corners must be finite;
/// polygons of more than three corners must be planar up to the tolerance.
Bsp build_bsp(PolygonSet polygons, const BspConfig& config = {});

enum class BspOrder { near_to_far, far_to_near };

/// Calls visit(node index) for every node in depth order as seen from `eye` (w = 1; w = 0: from infinitely far in that
/// direction; where it looks does not matter, 15.09). Fragments of earlier nodes never are (far_to_near: hide) what is
/// visited later. If the eye lies in a plane either order is right (E29).
template <class Visit>
void walk_bsp(const Bsp& bsp, const glm::dvec4& eye, BspOrder order, Visit&& visit) {
  if (bsp.nodes.empty()) return;
  constexpr std::uint32_t expanded = 0x80000000u;
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    const std::uint32_t entry = stack.back();
    stack.pop_back();
    const std::uint32_t index = entry & ~expanded;
    if ((entry & expanded) != 0) {
      visit(index);
      continue;
    }
    const BspNode& node = bsp.nodes[index];
    const bool in_front = node.plane.at(eye) >= 0.0;
    const bool front_first = in_front == (order == BspOrder::near_to_far);
    const std::uint32_t first = front_first ? node.front : node.back, last = front_first ? node.back : node.front;
    if (!is_bsp_leaf(last)) stack.push_back(last);
    if (is_bsp_leaf(first)) {
      visit(index);
      // What comes last was pushed already and is next.
      continue;
    }
    stack.push_back(index | expanded);
    stack.push_back(first);
  }
}

/// True if the leaf that holds p is inside. For a closed solid; on its surface either answer.
bool is_inside(const Bsp& bsp, const glm::dvec3& p);

/// Where a segment meets a polygon first.
struct BspHit {
  double t = 0.0;  // from + t * (to - from), 0 to 1
  std::uint32_t source = 0;
};

/// The first polygon that the closed segment touches (15.13, 15.14 with E31): end points and edges count, and so does a
/// segment within the plane of a polygon, from where it enters it. Of hits at the same t the lowest source. Returns
/// false if it meets none.
bool first_hit(const Bsp& bsp, const glm::dvec3& from, const glm::dvec3& to, BspHit& hit);

/// The same for one polygon: what first_hit asks the polygons of a node, and what tests ask all of them.
bool segment_meets_polygon(const glm::dvec3& from, const glm::dvec3& to, std::span<const glm::dvec3> polygon,
                           const BspPlane& plane, double tolerance, double& t);

/// Cuts a convex polygon at a plane (15.10, 15.11, E30): parts in front and behind, in its sense of rotation; corners
/// within the tolerance of the plane belong to both; new edges name `node`. Returns where the polygon lies.
enum class BspSide { on, front, back, both };
BspSide split_polygon(std::span<const BspCorner> polygon, const BspPlane& plane, std::uint32_t node, double tolerance,
                      std::vector<BspCorner>& front, std::vector<BspCorner>& back);

}  // namespace sightline
