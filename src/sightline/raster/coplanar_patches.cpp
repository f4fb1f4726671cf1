#include "sightline/raster/coplanar_patches.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <unordered_map>

#include "sightline/geometry/triangulate.hpp"
#include "sightline/scene/topology.hpp"

namespace sightline {
namespace {

__extension__ using Wide = __int128;

/// Outlines with more corners stay as they are: cutting ears off takes up to the third power of them.
constexpr std::size_t most_corners = 256;

/// Exact answers about points of a mesh.
class ExactPoints {
 public:
  explicit ExactPoints(const std::vector<glm::vec3>& positions) : positions_(positions) {
    int lowest = 1000, highest = -1000;
    for (const glm::vec3& p : positions)
      for (int axis = 0; axis < 3; ++axis) {
        if (p[axis] == 0.0f) continue;
        int exponent = 0;
        const float mantissa = std::frexp(std::abs(p[axis]), &exponent);
        auto bits = static_cast<std::uint32_t>(std::ldexp(mantissa, 24));
        highest = std::max(highest, exponent);
        int low = exponent - 24;
        for (; (bits & 1u) == 0; bits >>= 1) ++low;
        lowest = std::min(lowest, low);
      }
    if (highest - lowest > 30) return;  // differences need 31 bits, determinants of them 3 * 31 + 3
    grid_.reserve(positions.size());
    for (const glm::vec3& p : positions)
      grid_.push_back({static_cast<std::int64_t>(std::ldexp(static_cast<double>(p.x), -lowest)),
                       static_cast<std::int64_t>(std::ldexp(static_cast<double>(p.y), -lowest)),
                       static_cast<std::int64_t>(std::ldexp(static_cast<double>(p.z), -lowest))});
  }

  [[nodiscard]] bool coplanar(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const {
    for (int axis = 0; axis < 3; ++axis)
      if (equal(axis, a, b) && equal(axis, a, c) && equal(axis, a, d)) return true;
    if (grid_.empty()) return false;
    const auto u = difference(b, a), v = difference(c, a), w = difference(d, a);
    return determinant(u, v, w) == 0;
  }

  /// True if b lies strictly between a and c on their line.
  [[nodiscard]] bool between(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    if (!collinear(a, b, c)) return false;
    const glm::dvec3 p(positions_[a]), q(positions_[b]), r(positions_[c]);
    return glm::dot(q - p, r - q) > 0;
  }

 private:
  struct Integers {
    std::int64_t x, y, z;
  };
  [[nodiscard]] bool equal(int axis, std::uint32_t a, std::uint32_t b) const {
    return positions_[a][axis] == positions_[b][axis];
  }
  [[nodiscard]] Integers difference(std::uint32_t a, std::uint32_t b) const {
    return {grid_[a].x - grid_[b].x, grid_[a].y - grid_[b].y, grid_[a].z - grid_[b].z};
  }
  static Wide minor(std::int64_t a, std::int64_t b, std::int64_t c, std::int64_t d) {
    return static_cast<Wide>(a) * d - static_cast<Wide>(b) * c;
  }
  static Wide determinant(const Integers& u, const Integers& v, const Integers& w) {
    return u.x * minor(v.y, v.z, w.y, w.z) - u.y * minor(v.x, v.z, w.x, w.z) + u.z * minor(v.x, v.y, w.x, w.y);
  }
  [[nodiscard]] bool collinear(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    int same = 0;
    for (int axis = 0; axis < 3; ++axis) same += equal(axis, a, b) && equal(axis, a, c) ? 1 : 0;
    if (same >= 2) return true;
    if (grid_.empty()) return false;
    const auto u = difference(b, a), v = difference(c, a);
    return minor(u.x, u.y, v.x, v.y) == 0 && minor(u.y, u.z, v.y, v.z) == 0 && minor(u.x, u.z, v.x, v.z) == 0;
  }

  const std::vector<glm::vec3>& positions_;
  std::vector<Integers> grid_;  // empty if the coordinates do not fit
};

class Merger {
 public:
  Merger(const std::vector<glm::vec3>& positions, const std::vector<glm::uvec3>& triangles)
      : positions_(positions),
        triangles_(triangles),
        topology_(build_topology(positions, triangles)),
        exact_(positions),
        group_(triangles.size()) {}

  std::vector<Patch> merge() {
    group();
    find_droppable();
    std::vector<std::uint32_t> order;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
      if (topology_.triangle_edges[t].x != no_triangle) order.push_back(t);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return root(a) < root(b); });
    std::vector<Patch> patches;
    for (std::size_t begin = 0; begin < order.size();) {
      std::size_t end = begin;
      while (end < order.size() && root(order[end]) == root(order[begin])) ++end;
      patches.push_back(patch_of(std::span(order).subspan(begin, end - begin)));
      begin = end;
    }
    return patches;
  }

 private:
  std::uint32_t root(std::uint32_t t) {
    while (group_[t] != t) t = group_[t] = group_[group_[t]];
    return t;
  }
  [[nodiscard]] std::uint32_t corner(std::uint32_t t, int i) const { return topology_.welded[triangles_[t][i]]; }
  [[nodiscard]] glm::dvec3 normal(std::uint32_t t) const { return normal(corner(t, 0), corner(t, 1), corner(t, 2)); }
  [[nodiscard]] glm::dvec3 normal(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const glm::dvec3 p(positions_[a]);
    return glm::cross(glm::dvec3(positions_[b]) - p, glm::dvec3(positions_[c]) - p);
  }

  /// True if the edge runs within a patch.
  bool inner(const MeshEdge& edge) { return edge.count == 2 && root(edge.triangles[0]) == root(edge.triangles[1]); }

  void group() {
    std::iota(group_.begin(), group_.end(), 0u);
    for (const MeshEdge& edge : topology_.edges) {
      if (edge.count != 2 || edge.forward != 1) continue;
      const std::uint32_t s = edge.triangles[0], t = edge.triangles[1];
      std::uint32_t apex = corner(t, 0);
      for (int i = 1; i < 3; ++i)
        if (apex == edge.from || apex == edge.to) apex = corner(t, i);
      const glm::dvec3 n = normal(s), m = normal(t);
      if (!(glm::dot(n, m) > 0.5 * glm::length(n) * glm::length(m))) continue;  // folded back, or without area
      if (!exact_.coplanar(corner(s, 0), corner(s, 1), corner(s, 2), apex)) continue;
      const std::uint32_t a = root(s), b = root(t);
      group_[std::max(a, b)] = std::min(a, b);
    }
  }

  /// A vertex at which exactly two border edges meet, in one line, is a corner of nothing.
  void find_droppable() {
    std::vector<std::uint32_t> count(positions_.size(), 0);
    std::vector<glm::uvec2> other(positions_.size(), glm::uvec2(0));
    for (const MeshEdge& edge : topology_.edges) {
      if (inner(edge)) continue;
      for (const auto& [v, w] : {std::pair{edge.from, edge.to}, std::pair{edge.to, edge.from}})
        if (++count[v] <= 2) other[v][static_cast<int>(count[v]) - 1] = w;
    }
    droppable_.assign(positions_.size(), false);
    for (std::uint32_t v = 0; v < positions_.size(); ++v)
      droppable_[v] = count[v] == 2 && exact_.between(other[v].x, v, other[v].y);
  }

  Patch patch_of(std::span<const std::uint32_t> members) {
    Patch patch;
    patch.original = static_cast<std::uint32_t>(members.size());
    for (const std::uint32_t t : members) {
      patch.area += 0.5 * glm::length(normal(t));
      patch.triangles.emplace_back(corner(t, 0), corner(t, 1), corner(t, 2));
    }
    if (members.size() < 2) return patch;
    const auto outline = outline_of(members);
    if (!outline) return patch;
    auto fewer = triangulate(*outline, normal(largest(members)));
    if (!fewer.empty() && fewer.size() < patch.triangles.size()) patch.triangles = std::move(fewer);
    return patch;
  }

  [[nodiscard]] std::uint32_t largest(std::span<const std::uint32_t> members) const {
    return *std::max_element(members.begin(), members.end(),
                             [&](auto a, auto b) { return glm::length(normal(a)) < glm::length(normal(b)); });
  }

  using Loop = std::vector<std::uint32_t>;

  /// The border of a patch as loops of its corners; nothing if it touches itself.
  std::optional<std::vector<Loop>> outline_of(std::span<const std::uint32_t> members) {
    std::unordered_map<std::uint32_t, std::uint32_t> next;
    std::vector<std::uint32_t> starts;
    for (const std::uint32_t t : members)
      for (int side = 0; side < 3; ++side) {
        if (inner(topology_.edges[topology_.triangle_edges[t][side]])) continue;
        const std::uint32_t from = corner(t, side), to = corner(t, (side + 1) % 3);
        if (!next.emplace(from, to).second) return std::nullopt;
        starts.push_back(from);
      }
    std::vector<Loop> loops;
    for (const std::uint32_t start : starts) {
      Loop loop;
      for (std::uint32_t v = start; next.contains(v);) {
        if (!droppable_[v]) loop.push_back(v);
        const std::uint32_t to = next[v];
        next.erase(v);
        v = to;
      }
      if (loop.empty()) continue;
      if (loop.size() < 3) return std::nullopt;
      loops.push_back(std::move(loop));
    }
    return loops;
  }

  /// Triangles whose borders add up to the loops and which all turn like the patch: then they cover it exactly once.
  std::vector<glm::uvec3> triangulate(std::vector<Loop> loops, const glm::dvec3& plane_normal) {
    Loop polygon = join_loops(std::move(loops), plane_normal);
    if (polygon.size() < 3) return {};
    std::vector<glm::vec3> corners;
    for (const std::uint32_t v : polygon) corners.push_back(positions_[v]);
    std::vector<glm::uvec3> result;
    const double size = glm::length(plane_normal);
    for (const glm::uvec3& t : triangulate_polygon(corners)) {
      const glm::uvec3 named(polygon[t.x], polygon[t.y], polygon[t.z]);
      const glm::dvec3 n = normal(named.x, named.y, named.z);
      if (!(glm::dot(n, plane_normal) > 1e-9 * size * longest_squared(named))) return {};
      result.push_back(named);
    }
    return result;
  }

  [[nodiscard]] double longest_squared(const glm::uvec3& t) const {
    double longest = 0;
    for (int i = 0; i < 3; ++i) {
      const glm::dvec3 d = glm::dvec3(positions_[t[i]]) - glm::dvec3(positions_[t[(i + 1) % 3]]);
      longest = std::max(longest, glm::dot(d, d));
    }
    return longest;
  }

  /// One polygon from an outer loop and its holes: each hole is reached over a bridge that is walked both ways. Which
  /// bridge is a guess that the check of the triangles confirms.
  Loop join_loops(std::vector<Loop> loops, const glm::dvec3& plane_normal) {
    std::size_t corners = 0;
    for (const Loop& loop : loops) corners += loop.size();
    if (loops.empty() || corners + 2 * loops.size() > most_corners) return {};
    const glm::dvec3 size = glm::abs(plane_normal);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
    const int u = plane_normal[axis] >= 0 ? (axis + 1) % 3 : (axis + 2) % 3, v = 3 - axis - u;
    const auto flat = [&](std::uint32_t i) { return glm::dvec2(positions_[i][u], positions_[i][v]); };
    const auto area = [&](const Loop& loop) {
      double sum = 0;
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const glm::dvec2 a = flat(loop[i]) - flat(loop[0]), b = flat(loop[(i + 1) % loop.size()]) - flat(loop[0]);
        sum += a.x * b.y - a.y * b.x;
      }
      return sum;
    };
    const auto outer =
        std::max_element(loops.begin(), loops.end(), [&](const Loop& a, const Loop& b) { return area(a) < area(b); });
    Loop polygon = std::move(*outer);
    loops.erase(outer);
    const auto rightmost = [&](const Loop& loop) {
      return *std::max_element(loop.begin(), loop.end(), [&](auto a, auto b) { return flat(a).x < flat(b).x; });
    };
    std::sort(loops.begin(), loops.end(),
              [&](const Loop& a, const Loop& b) { return flat(rightmost(a)).x > flat(rightmost(b)).x; });
    const auto turn = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      const glm::dvec2 p = flat(a), q = flat(b) - p, r = flat(c) - p;
      return q.x * r.y - q.y * r.x;
    };
    for (const Loop& hole : loops) {
      const std::uint32_t from = rightmost(hole);
      std::size_t best = polygon.size();
      double shortest = 1e300;
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const double length = glm::distance(flat(polygon[i]), flat(from));
        if (length >= shortest) continue;
        bool free = true;
        const auto clear_of = [&](const Loop& loop) {
          for (std::size_t k = 0; k < loop.size() && free; ++k) {
            const std::uint32_t a = loop[k], b = loop[(k + 1) % loop.size()];
            if (a == from || b == from || a == polygon[i] || b == polygon[i]) continue;
            free = !(turn(from, polygon[i], a) * turn(from, polygon[i], b) <= 0 &&
                     turn(a, b, from) * turn(a, b, polygon[i]) <= 0);
          }
        };
        clear_of(polygon);
        for (const Loop& other : loops) clear_of(other);
        if (!free) continue;
        best = i;
        shortest = length;
      }
      if (best == polygon.size()) return {};
      const auto start = static_cast<std::size_t>(std::find(hole.begin(), hole.end(), from) - hole.begin());
      Loop bridge;
      for (std::size_t k = 0; k <= hole.size(); ++k) bridge.push_back(hole[(start + k) % hole.size()]);
      bridge.push_back(polygon[best]);
      polygon.insert(polygon.begin() + static_cast<std::ptrdiff_t>(best) + 1, bridge.begin(), bridge.end());
    }
    return polygon;
  }

  const std::vector<glm::vec3>& positions_;
  const std::vector<glm::uvec3>& triangles_;
  Topology topology_;
  ExactPoints exact_;
  std::vector<std::uint32_t> group_;
  std::vector<bool> droppable_;
};

}  // namespace

std::vector<Patch> coplanar_patches(const std::vector<glm::vec3>& positions, const std::vector<glm::uvec3>& triangles) {
  return Merger(positions, triangles).merge();
}

}  // namespace sightline
