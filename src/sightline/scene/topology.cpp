#include "sightline/scene/topology.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

namespace sightline {
namespace {

/// -0 and +0 are the same place.
std::array<std::uint32_t, 3> bits_of(const glm::vec3& p) {
  return {std::bit_cast<std::uint32_t>(p.x + 0.0f), std::bit_cast<std::uint32_t>(p.y + 0.0f),
          std::bit_cast<std::uint32_t>(p.z + 0.0f)};
}

std::uint64_t hash_of(const std::array<std::uint32_t, 3>& bits) {
  std::uint64_t h = (std::uint64_t{bits[0]} << 32 | bits[1]) * 0x9E3779B97F4A7C15u;
  h = (h ^ h >> 29 ^ bits[2]) * 0xBF58476D1CE4E5B9u;
  return h ^ h >> 32;
}

/// By a table with open addressing, half full at most.
std::vector<std::uint32_t> weld(std::span<const glm::vec3> positions) {
  std::vector<std::uint32_t> welded(positions.size());
  const std::size_t mask = std::bit_ceil(2 * positions.size() + 1) - 1;
  std::vector<std::uint32_t> table(mask + 1, no_triangle);
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    const std::array<std::uint32_t, 3> bits = bits_of(positions[i]);
    std::size_t slot = hash_of(bits) & mask;
    while (table[slot] != no_triangle && bits_of(positions[table[slot]]) != bits) slot = (slot + 1) & mask;
    if (table[slot] == no_triangle) table[slot] = i;
    welded[i] = table[slot];
  }
  return welded;
}

/// A side of a triangle, from its lower vertex to `to`.
struct HalfEdge {
  std::uint32_t to;
  std::uint32_t triangle;
  std::uint8_t side;
  bool forward;
};

/// All sides of all triangles with three different vertices, ordered by (lower vertex, upper vertex, triangle, side): a
/// counting sort by the lower vertex, then the few at each vertex by the upper one.
struct HalfEdges {
  std::vector<std::uint32_t> begin;  // of the sides from each vertex; one more at the end
  std::vector<HalfEdge> halves;

  HalfEdges(const std::vector<std::uint32_t>& welded, std::span<const glm::uvec3> triangles)
      : begin(welded.size() + 1, 0) {
    const auto each_side = [&](auto&& use) {
      for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        const std::array<std::uint32_t, 3> v{welded[triangles[t].x], welded[triangles[t].y], welded[triangles[t].z]};
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
        for (std::uint8_t side = 0; side < 3; ++side) {
          const std::uint32_t a = v[side], b = v[(side + 1) % 3];
          use(std::min(a, b), HalfEdge{std::max(a, b), t, side, a < b});
        }
      }
    };
    each_side([&](std::uint32_t from, const HalfEdge&) { ++begin[from]; });
    std::exclusive_scan(begin.begin(), begin.end(), begin.begin(), 0u);
    halves.resize(begin.back());
    std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
    each_side([&](std::uint32_t from, const HalfEdge& half) { halves[next[from]++] = half; });
    for (std::size_t v = 0; v < welded.size(); ++v) sort_by_end({halves.data() + begin[v], begin[v + 1] - begin[v]});
  }

 private:
  static void sort_by_end(std::span<HalfEdge> part) {
    constexpr std::size_t few = 24;
    const auto lower = [](const HalfEdge& a, const HalfEdge& b) { return a.to < b.to; };
    if (part.size() > few) {
      std::stable_sort(part.begin(), part.end(), lower);
      return;
    }
    for (std::size_t i = 1; i < part.size(); ++i) {
      const HalfEdge half = part[i];
      std::size_t place = i;
      for (; place > 0 && half.to < part[place - 1].to; --place) part[place] = part[place - 1];
      part[place] = half;
    }
  }
};

}  // namespace

Topology build_topology(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles) {
  Topology topology;
  topology.welded = weld(positions);
  topology.triangle_edges.assign(triangles.size(), glm::uvec3(no_triangle));
  const HalfEdges sides(topology.welded, triangles);
  for (std::uint32_t from = 0; from < positions.size(); ++from)
    for (std::uint32_t i = sides.begin[from]; i < sides.begin[from + 1]; ++i) {
      const HalfEdge& half = sides.halves[i];
      if (topology.edges.empty() || topology.edges.back().from != from || topology.edges.back().to != half.to)
        topology.edges.push_back({from, half.to, {no_triangle, no_triangle}, 0, 0});
      MeshEdge& edge = topology.edges.back();
      if (edge.count < 2) edge.triangles[edge.count] = half.triangle;
      ++edge.count;
      edge.forward += half.forward ? 1u : 0u;
      topology.triangle_edges[half.triangle][half.side] = static_cast<std::uint32_t>(topology.edges.size() - 1);
    }
  return topology;
}

bool is_closed(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles) {
  const HalfEdges sides(weld(positions), triangles);
  const std::vector<HalfEdge>& all = sides.halves;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const std::size_t end = sides.begin[v + 1];
    if ((end - sides.begin[v]) % 2 != 0) return false;
    for (std::size_t i = sides.begin[v]; i < end; i += 2) {  // pairs, of opposite direction, and no third
      if (all[i].to != all[i + 1].to || all[i].forward == all[i + 1].forward) return false;
      if (i + 2 < end && all[i + 2].to == all[i].to) return false;
    }
  }
  return !all.empty();
}

bool is_closed(const Topology& topology) {
  return !topology.edges.empty() && std::all_of(topology.edges.begin(), topology.edges.end(),
                                                [](const MeshEdge& e) { return e.count == 2 && e.forward == 1; });
}

}  // namespace sightline
