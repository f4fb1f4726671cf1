#include "sightline/raster/occluder_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sightline/scene/topology.hpp"

namespace sightline {
namespace {

constexpr std::size_t padding = 16;

template <class T>
void pad(std::vector<T>& array, T value) {
  array.resize(array.size() + padding, value);
}

/// Disjoint sets of numbers 0 .. n-1 (Tarjan 1975), the least number of each stands for it.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// For every triangle with area its component, numbered by first appearance; no_triangle for the others. Triangles hang
/// together if they share an edge, however many others share it too.
std::vector<std::uint32_t> components(const Topology& topology, std::uint32_t& count) {
  const auto triangles = static_cast<std::uint32_t>(topology.triangle_edges.size());
  DisjointSets sets(triangles + topology.edges.size());
  for (std::uint32_t t = 0; t < triangles; ++t)
    for (int side = 0; side < 3; ++side)
      if (topology.triangle_edges[t][side] != no_triangle) sets.join(t, triangles + topology.triangle_edges[t][side]);
  std::vector<std::uint32_t> component(triangles, no_triangle);
  count = 0;
  for (std::uint32_t t = 0; t < triangles; ++t) {
    if (topology.triangle_edges[t].x == no_triangle) continue;
    const std::uint32_t root = sets.find(t);  // the least of its set, so never behind t
    component[t] = root == t ? count++ : component[root];
  }
  return component;
}

/// Indices 0 .. keys.size()-1 ordered by key, those with key no_triangle left out; begin[k] is where key k starts.
std::vector<std::uint32_t> order_by(const std::vector<std::uint32_t>& keys, std::uint32_t count,
                                    std::vector<std::uint32_t>& begin) {
  begin.assign(count + 1, 0);
  for (const std::uint32_t key : keys)
    if (key != no_triangle) ++begin[key + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> order(begin.back()), next = begin;
  for (std::uint32_t i = 0; i < keys.size(); ++i)
    if (keys[i] != no_triangle) order[next[keys[i]]++] = i;
  return order;
}

void add_plane(OccluderMesh& mesh, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double length = glm::length(normal);
  const bool plane = length > 0.0 && std::isfinite(length);
  const glm::vec3 unit = plane ? glm::vec3(normal / length) : glm::vec3(0.0f);
  mesh.normal_x.push_back(unit.x);
  mesh.normal_y.push_back(unit.y);
  mesh.normal_z.push_back(unit.z);
  mesh.offset.push_back(plane ? static_cast<float>(-glm::dot(normal / length, a)) : 0.0f);
}

}  // namespace

OccluderMesh make_occluder(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles) {
  const Topology topology = build_topology(positions, triangles);
  OccluderMesh mesh;
  mesh.closed = is_closed(topology);

  std::uint32_t count = 0;
  const std::vector<std::uint32_t> component = components(topology, count);
  const std::vector<std::uint32_t> triangle_order = order_by(component, count, mesh.triangle_begin);
  std::vector<std::uint32_t> edge_component;
  edge_component.reserve(topology.edges.size());
  for (const MeshEdge& edge : topology.edges) edge_component.push_back(component[edge.triangles[0]]);
  const std::vector<std::uint32_t> edge_order = order_by(edge_component, count, mesh.edge_begin);

  std::vector<std::int32_t> renamed(positions.size(), -1);  // of the current component if not below its first vertex
  const auto vertex = [&](std::uint32_t original) {
    const std::uint32_t v = topology.welded[original];
    if (renamed[v] < static_cast<std::int32_t>(mesh.vertex_begin.back())) {
      renamed[v] = static_cast<std::int32_t>(mesh.x.size());
      mesh.x.push_back(positions[v].x);
      mesh.y.push_back(positions[v].y);
      mesh.z.push_back(positions[v].z);
      mesh.bounds.extend(positions[v]);
    }
    return renamed[v];
  };
  const auto nothing = static_cast<std::int32_t>(triangle_order.size());
  std::vector<std::int32_t> kept(triangles.size(), -1);
  for (std::uint32_t c = 0; c < count; ++c) {
    mesh.vertex_begin.push_back(static_cast<std::uint32_t>(mesh.x.size()));
    for (std::uint32_t i = mesh.triangle_begin[c]; i < mesh.triangle_begin[c + 1]; ++i) {
      const glm::uvec3& t = triangles[triangle_order[i]];
      kept[triangle_order[i]] = static_cast<std::int32_t>(i);
      mesh.corner0.push_back(vertex(t.x));
      mesh.corner1.push_back(vertex(t.y));
      mesh.corner2.push_back(vertex(t.z));
      add_plane(mesh, positions[t.x], positions[t.y], positions[t.z]);
    }
    for (std::uint32_t i = mesh.edge_begin[c]; i < mesh.edge_begin[c + 1]; ++i) {
      const MeshEdge& edge = topology.edges[edge_order[i]];
      mesh.edge_from.push_back(vertex(edge.from));
      mesh.edge_to.push_back(vertex(edge.to));
      mesh.edge_first.push_back(edge.count <= 2 ? kept[edge.triangles[0]] : nothing + 1);
      mesh.edge_second.push_back(edge.count == 2 ? kept[edge.triangles[1]] : nothing);
      mesh.edge_winding.push_back(edge.forward == 1 ? 1.0f : -1.0f);
    }
  }
  mesh.vertex_begin.push_back(static_cast<std::uint32_t>(mesh.x.size()));
  mesh.vertex_count = static_cast<std::uint32_t>(mesh.x.size());
  mesh.triangle_count = static_cast<std::uint32_t>(mesh.corner0.size());
  mesh.edge_count = static_cast<std::uint32_t>(mesh.edge_from.size());
  for (auto* array :
       {&mesh.x, &mesh.y, &mesh.z, &mesh.normal_x, &mesh.normal_y, &mesh.normal_z, &mesh.offset, &mesh.edge_winding})
    pad(*array, 0.0f);
  for (auto* array : {&mesh.corner0, &mesh.corner1, &mesh.corner2, &mesh.edge_from, &mesh.edge_to}) pad(*array, 0);
  for (auto* array : {&mesh.edge_first, &mesh.edge_second}) pad(*array, nothing);
  return mesh;
}

}  // namespace sightline
