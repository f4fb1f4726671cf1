#include "sightline/raster/raw_occluder.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

namespace sightline {
namespace {

constexpr std::size_t padding = 16;
constexpr std::uint32_t none = 0xFFFFFFFFu;

/// Numbers 0 .. keys-1 ordered by key(i); begin[k] is where key k starts. Counting sort.
template <class Key>
void order_by(std::size_t count, std::uint32_t keys, const Key& key, std::vector<std::uint32_t>& begin,
              std::vector<std::uint32_t>& next, std::vector<std::uint32_t>& order) {
  begin.assign(keys + 1, 0);
  for (std::uint32_t i = 0; i < count; ++i) ++begin[key(i) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  next.assign(begin.begin(), begin.end());
  order.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) order[next[key(i)]++] = i;
}

}  // namespace

std::uint32_t RawOccluder::root(std::uint32_t i) {
  while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
  return i;
}

void RawOccluder::find_edges(std::span<const glm::uvec3> triangles) {
  kept_.clear();
  edges_.clear();
  slots_.assign(std::bit_ceil(6 * triangles.size() + 1), none);
  const std::size_t mask = slots_.size() - 1;
  for (const glm::uvec3& t : triangles) {
    if (t.x == t.y || t.y == t.z || t.z == t.x) continue;
    const auto triangle = static_cast<std::uint32_t>(kept_.size());
    kept_.push_back(t);
    for (int side = 0; side < 3; ++side) {
      const std::uint32_t a = t[side], b = t[(side + 1) % 3], from = std::min(a, b), to = std::max(a, b);
      std::size_t slot =
          ((from * std::uint64_t{0x9E3779B97F4A7C15u}) ^ (to * std::uint64_t{0xC2B2AE3D27D4EB4Fu})) >> 20;
      for (slot &= mask; slots_[slot] != none; slot = (slot + 1) & mask)
        if (edges_[slots_[slot]].from == from && edges_[slots_[slot]].to == to) break;
      if (slots_[slot] == none) {
        slots_[slot] = static_cast<std::uint32_t>(edges_.size());
        edges_.push_back({from, to, triangle, triangle, 0, 0});
      }
      Edge& edge = edges_[slots_[slot]];
      if (edge.count == 1) edge.second = triangle;
      ++edge.count;
      edge.forward += a < b ? 1u : 0u;
    }
  }
}

/// Triangles that share an edge with two triangles hang together; numbered by first appearance.
void RawOccluder::find_components(std::uint32_t triangle_count) {
  parents_.resize(triangle_count);
  std::iota(parents_.begin(), parents_.end(), 0u);
  for (const Edge& edge : edges_) {
    const std::uint32_t a = root(edge.first), b = root(edge.second);
    parents_[std::max(a, b)] = std::min(a, b);
  }
  component_.resize(triangle_count);
}

const OccluderMesh& RawOccluder::make(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles) {
  OccluderMesh& m = mesh_;
  find_edges(triangles);
  const auto triangle_count = static_cast<std::uint32_t>(kept_.size());
  find_components(triangle_count);
  std::uint32_t count = 0;
  for (std::uint32_t t = 0; t < triangle_count; ++t) component_[t] = root(t) == t ? count++ : component_[root(t)];
  order_by(triangle_count, count, [&](std::uint32_t t) { return component_[t]; }, m.triangle_begin, next_, order_);
  order_by(
      edges_.size(), count, [&](std::uint32_t e) { return component_[edges_[e].first]; }, m.edge_begin, next_,
      edge_order_);

  for (auto* array : {&m.x, &m.y, &m.z, &m.edge_winding}) array->clear();
  for (auto* array : {&m.corner0, &m.corner1, &m.corner2, &m.edge_from, &m.edge_to, &m.edge_first, &m.edge_second})
    array->clear();
  m.vertex_begin.clear();
  m.bounds = {};
  m.closed = !edges_.empty();
  renamed_.assign(positions.size(), -1);
  place_.resize(triangle_count);
  const auto vertex = [&](std::uint32_t v) {
    if (renamed_[v] < static_cast<std::int32_t>(m.vertex_begin.back())) {
      renamed_[v] = static_cast<std::int32_t>(m.x.size());
      m.x.push_back(positions[v].x);
      m.y.push_back(positions[v].y);
      m.z.push_back(positions[v].z);
      m.bounds.extend(positions[v]);
    }
    return renamed_[v];
  };
  const auto nothing = static_cast<std::int32_t>(triangle_count);
  for (std::uint32_t c = 0; c < count; ++c) {
    m.vertex_begin.push_back(static_cast<std::uint32_t>(m.x.size()));
    for (std::uint32_t i = m.triangle_begin[c]; i < m.triangle_begin[c + 1]; ++i) {
      const glm::uvec3& t = kept_[order_[i]];
      place_[order_[i]] = static_cast<std::int32_t>(i);
      m.corner0.push_back(vertex(t.x));
      m.corner1.push_back(vertex(t.y));
      m.corner2.push_back(vertex(t.z));
    }
    for (std::uint32_t i = m.edge_begin[c]; i < m.edge_begin[c + 1]; ++i) {
      const Edge& edge = edges_[edge_order_[i]];
      m.edge_from.push_back(vertex(edge.from));
      m.edge_to.push_back(vertex(edge.to));
      m.edge_first.push_back(edge.count <= 2 ? place_[edge.first] : nothing + 1);
      m.edge_second.push_back(edge.count == 2 ? place_[edge.second] : nothing);
      m.edge_winding.push_back(edge.forward == 1 ? 1.0f : -1.0f);
      m.closed = m.closed && edge.count == 2 && edge.forward == 1;
    }
  }
  m.vertex_begin.push_back(static_cast<std::uint32_t>(m.x.size()));
  m.vertex_count = static_cast<std::uint32_t>(m.x.size());
  m.triangle_count = triangle_count;
  m.edge_count = static_cast<std::uint32_t>(m.edge_from.size());
  for (auto* array : {&m.x, &m.y, &m.z, &m.edge_winding}) array->resize(array->size() + padding, 0.0f);
  for (auto* array : {&m.corner0, &m.corner1, &m.corner2, &m.edge_from, &m.edge_to})
    array->resize(array->size() + padding, 0);
  for (auto* array : {&m.edge_first, &m.edge_second}) array->resize(array->size() + padding, nothing);
  return m;
}

}  // namespace sightline
