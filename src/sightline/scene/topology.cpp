#include "sightline/scene/topology.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

namespace sightline {
namespace {

std::vector<std::uint32_t> weld(std::span<const glm::vec3> positions) {
  std::vector<std::uint32_t> order(positions.size()), welded(positions.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t i) { return std::tuple(positions[i].x, positions[i].y, positions[i].z); };
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && key(order[i]) == key(order[i - 1]);
    welded[order[i]] = same ? welded[order[i - 1]] : order[i];
  }
  return welded;
}

struct HalfEdge {
  std::uint32_t from, to, triangle, side;
  bool forward;
};

}  // namespace

Topology build_topology(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles) {
  Topology topology;
  topology.welded = weld(positions);
  topology.triangle_edges.assign(triangles.size(), glm::uvec3(no_triangle));
  std::vector<HalfEdge> halves;
  halves.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const std::array<std::uint32_t, 3> v{topology.welded[triangles[t].x], topology.welded[triangles[t].y],
                                         topology.welded[triangles[t].z]};
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
    for (std::uint32_t side = 0; side < 3; ++side) {
      const std::uint32_t a = v[side], b = v[(side + 1) % 3];
      halves.push_back({std::min(a, b), std::max(a, b), t, side, a < b});
    }
  }
  std::sort(halves.begin(), halves.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::tie(a.from, a.to, a.triangle, a.side) < std::tie(b.from, b.to, b.triangle, b.side);
  });
  for (const HalfEdge& half : halves) {
    if (topology.edges.empty() || topology.edges.back().from != half.from || topology.edges.back().to != half.to)
      topology.edges.push_back({half.from, half.to, {no_triangle, no_triangle}, 0, 0});
    MeshEdge& edge = topology.edges.back();
    if (edge.count < 2) edge.triangles[edge.count] = half.triangle;
    ++edge.count;
    edge.forward += half.forward ? 1u : 0u;
    topology.triangle_edges[half.triangle][static_cast<int>(half.side)] =
        static_cast<std::uint32_t>(topology.edges.size() - 1);
  }
  return topology;
}

bool is_closed(const Topology& topology) {
  return !topology.edges.empty() && std::all_of(topology.edges.begin(), topology.edges.end(),
                                                [](const MeshEdge& e) { return e.count == 2 && e.forward == 1; });
}

}  // namespace sightline
