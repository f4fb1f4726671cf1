#include "sightline/raster/wall_fences.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "sightline/scene/topology.hpp"

namespace sightline {
namespace {

/// An upright rectangle; `ends` are the welded vertices at the bottom and top of its two upright edges, no_triangle
/// where there is no such vertex.
struct Wall {
  glm::dvec2 from, to;
  double y0, y1;
  std::uint32_t ends[2][2];
};

class Finder {
 public:
  Finder(const Mesh& mesh, const glm::dmat3& linear)
      : mesh_(mesh), topology_(build_topology(mesh.positions, mesh.triangles)) {
    double size = 0;
    for (const glm::vec3& p : mesh.positions) {
      points_.push_back(linear * glm::dvec3(p));
      size = std::max({size, std::abs(points_.back().x), std::abs(points_.back().y), std::abs(points_.back().z)});
    }
    slack_ = 4e-6 * size;
  }

  WallFences find() {
    group();
    std::vector<std::uint32_t> order;
    for (std::uint32_t t = 0; t < group_.size(); ++t)
      if (upright_[t]) order.push_back(t);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return root(a) < root(b); });
    for (std::size_t begin = 0; begin < order.size();) {
      std::size_t end = begin;
      while (end < order.size() && root(order[end]) == root(order[begin])) ++end;
      add_wall(std::span(order).subspan(begin, end - begin));
      begin = end;
    }
    return {chains(), 4 * slack_};
  }

 private:
  glm::dvec3 corner(std::uint32_t triangle, int i) const {
    return points_[topology_.welded[mesh_.triangles[triangle][i]]];
  }
  static glm::dvec2 plan(const glm::dvec3& p) { return {p.x, p.z}; }
  static double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

  std::uint32_t root(std::uint32_t t) {
    while (group_[t] != t) t = group_[t] = group_[group_[t]];
    return t;
  }

  /// The longest edge of a triangle in plan.
  std::pair<glm::dvec2, glm::dvec2> line_of(std::uint32_t t) const {
    std::pair<glm::dvec2, glm::dvec2> best{plan(corner(t, 0)), plan(corner(t, 1))};
    for (int i = 1; i < 3; ++i) {
      const glm::dvec2 a = plan(corner(t, i)), b = plan(corner(t, (i + 1) % 3));
      if (glm::distance(a, b) > glm::distance(best.first, best.second)) best = {a, b};
    }
    return best;
  }

  bool on_line(const std::pair<glm::dvec2, glm::dvec2>& line, const glm::dvec2& p) const {
    const glm::dvec2 along = line.second - line.first;
    return std::abs(cross(along, p - line.first)) <= slack_ * glm::length(along);
  }

  /// Upright triangles, joined across edges where they lie in one plane.
  void group() {
    group_.resize(mesh_.triangles.size());
    std::iota(group_.begin(), group_.end(), 0u);
    upright_.assign(mesh_.triangles.size(), false);
    for (std::uint32_t t = 0; t < group_.size(); ++t) {
      if (topology_.triangle_edges[t].x == no_triangle) continue;
      const auto line = line_of(t);
      upright_[t] = glm::distance(line.first, line.second) > 8 * slack_ && on_line(line, plan(corner(t, 0))) &&
                    on_line(line, plan(corner(t, 1))) && on_line(line, plan(corner(t, 2)));
    }
    for (const MeshEdge& edge : topology_.edges) {
      if (edge.count != 2 || !upright_[edge.triangles[0]] || !upright_[edge.triangles[1]]) continue;
      const auto a = line_of(edge.triangles[0]), b = line_of(edge.triangles[1]);
      const glm::dvec2 da = a.second - a.first, db = b.second - b.first;
      if (std::abs(cross(da, db)) > 1e-5 * glm::length(da) * glm::length(db)) continue;
      if (!on_line(a, b.first) || !on_line(a, b.second) || !on_line(b, a.first) || !on_line(b, a.second)) continue;
      group_[std::max(root(edge.triangles[0]), root(edge.triangles[1]))] =
          std::min(root(edge.triangles[0]), root(edge.triangles[1]));
    }
  }

  struct Border {
    glm::dvec2 a, b;  // along the wall, and height
    std::uint32_t from, to;
  };

  std::vector<Border> borders(std::span<const std::uint32_t> triangles, const glm::dvec2& origin,
                              const glm::dvec2& along) {
    std::vector<Border> list;
    for (const std::uint32_t t : triangles)
      for (int side = 0; side < 3; ++side) {
        const MeshEdge& edge = topology_.edges[topology_.triangle_edges[t][side]];
        const auto mine = [&](std::uint32_t other) {
          return other != no_triangle && upright_[other] && root(other) == root(t);
        };
        if (edge.count == 2 && mine(edge.triangles[0]) && mine(edge.triangles[1])) continue;
        const auto flat = [&](std::uint32_t v) {
          return glm::dvec2(glm::dot(plan(points_[v]) - origin, along), points_[v].y);
        };
        list.push_back({flat(edge.from), flat(edge.to), edge.from, edge.to});
      }
    return list;
  }

  /// The heights that border edges cover at one end of a wall.
  std::pair<double, double> upright_range(const std::vector<Border>& list, double s) const {
    std::pair<double, double> range{1e300, -1e300};
    for (const Border& e : list)
      if (std::abs(e.a.x - s) <= slack_ && std::abs(e.b.x - s) <= slack_) {
        range.first = std::min({range.first, e.a.y, e.b.y});
        range.second = std::max({range.second, e.a.y, e.b.y});
      }
    return range;
  }

  /// True if a segment has a point within the open rectangle (Liang and Barsky 1984).
  static bool crosses(const Border& e, double s0, double s1, double y0, double y1) {
    double from = 0, to = 1;
    const auto clip = [&](double p, double q) {  // p * t < q
      if (p == 0) return q > 0;
      if (p > 0)
        to = std::min(to, q / p);
      else
        from = std::max(from, q / p);
      return from < to;
    };
    const glm::dvec2 d = e.b - e.a;
    return clip(-d.x, e.a.x - s0) && clip(d.x, s1 - e.a.x) && clip(-d.y, e.a.y - y0) && clip(d.y, y1 - e.a.y);
  }

  std::uint32_t vertex_at(const std::vector<Border>& list, double s, double y) const {
    for (const Border& e : list)
      for (const auto& [point, v] : {std::pair{e.a, e.from}, std::pair{e.b, e.to}})
        if (std::abs(point.x - s) <= slack_ && std::abs(point.y - y) <= slack_) return v;
    return no_triangle;
  }

  void add_wall(std::span<const std::uint32_t> triangles) {
    const auto [first, second] = line_of(triangles[0]);
    const glm::dvec2 along = glm::normalize(second - first);
    const std::vector<Border> list = borders(triangles, first, along);
    double s0 = 1e300, s1 = -1e300;
    for (const Border& e : list) {
      s0 = std::min({s0, e.a.x, e.b.x});
      s1 = std::max({s1, e.a.x, e.b.x});
    }
    if (!(s1 - s0 > 8 * slack_)) return;
    const auto [a0, a1] = upright_range(list, s0);
    const auto [b0, b1] = upright_range(list, s1);
    const double y0 = std::max(a0, b0), y1 = std::min(a1, b1);
    if (!(y1 - y0 > 8 * slack_)) return;
    for (const Border& e : list)
      if (crosses(e, s0 + 2 * slack_, s1 - 2 * slack_, y0 + 2 * slack_, y1 - 2 * slack_)) return;
    walls_.push_back(
        {first + along * s0,
         first + along * s1,
         y0,
         y1,
         {{vertex_at(list, s0, y0), vertex_at(list, s0, y1)}, {vertex_at(list, s1, y0), vertex_at(list, s1, y1)}}});
  }

  /// Joins walls of equal heights at the upright edges that two of them share.
  std::vector<WallFence> chains() {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::pair<std::size_t, int>>> at;
    for (std::size_t w = 0; w < walls_.size(); ++w)
      for (int end = 0; end < 2; ++end)
        if (walls_[w].ends[end][0] != no_triangle && walls_[w].ends[end][1] != no_triangle)
          at[{walls_[w].ends[end][0], walls_[w].ends[end][1]}].emplace_back(w, end);
    const auto neighbour = [&](std::size_t w, int end) -> std::pair<std::size_t, int> {
      const Wall& wall = walls_[w];
      const auto found = at.find({wall.ends[end][0], wall.ends[end][1]});
      if (found == at.end() || found->second.size() != 2) return {w, -1};
      const auto& pair = found->second;
      return pair[0].first == w && pair[0].second == end ? pair[1] : pair[0];
    };
    std::vector<bool> used(walls_.size(), false);
    std::vector<WallFence> fences;
    for (std::size_t start = 0; start < walls_.size(); ++start) {
      if (used[start]) continue;
      // Back to where the chain begins, or once around a loop.
      std::size_t w = start;
      int end = 0;
      for (auto n = neighbour(w, end); n.second >= 0 && n.first != start && !used[n.first]; n = neighbour(w, end)) {
        w = n.first;
        end = 1 - n.second;
      }
      WallFence fence;
      fence.y0 = walls_[w].y0;
      fence.y1 = walls_[w].y1;
      fence.plan.push_back(end == 0 ? walls_[w].from : walls_[w].to);
      while (true) {
        used[w] = true;
        fence.y0 = std::max(fence.y0, walls_[w].y0);
        fence.y1 = std::min(fence.y1, walls_[w].y1);
        fence.plan.push_back(end == 0 ? walls_[w].to : walls_[w].from);
        const auto n = neighbour(w, 1 - end);
        if (n.second < 0 || used[n.first]) break;
        w = n.first;
        end = n.second;
      }
      if (fence.y1 > fence.y0) fences.push_back(std::move(fence));
    }
    return fences;
  }

  const Mesh& mesh_;
  Topology topology_;
  std::vector<glm::dvec3> points_;
  double slack_ = 0;
  std::vector<std::uint32_t> group_;
  std::vector<bool> upright_;
  std::vector<Wall> walls_;
};

}  // namespace

WallFences find_wall_fences(const Mesh& mesh, const glm::dmat3& linear) { return Finder(mesh, linear).find(); }

}  // namespace sightline
