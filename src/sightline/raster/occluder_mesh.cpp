#include "sightline/raster/occluder_mesh.hpp"

#include "sightline/scene/topology.hpp"

namespace sightline {
namespace {

constexpr std::size_t padding = 16;

template <class T>
void pad(std::vector<T>& array, T value) {
  array.resize(array.size() + padding, value);
}

}  // namespace

OccluderMesh make_occluder(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles) {
  const Topology topology = build_topology(positions, triangles);
  OccluderMesh mesh;
  mesh.closed = is_closed(topology);

  std::vector<std::int32_t> renamed(positions.size(), -1);
  const auto vertex = [&](std::uint32_t original) {
    const std::uint32_t v = topology.welded[original];
    if (renamed[v] < 0) {
      renamed[v] = static_cast<std::int32_t>(mesh.x.size());
      mesh.x.push_back(positions[v].x);
      mesh.y.push_back(positions[v].y);
      mesh.z.push_back(positions[v].z);
      mesh.bounds.extend(positions[v]);
    }
    return renamed[v];
  };
  std::vector<std::int32_t> kept(triangles.size(), -1);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    if (topology.triangle_edges[t].x == no_triangle) continue;
    kept[t] = static_cast<std::int32_t>(mesh.corner0.size());
    mesh.corner0.push_back(vertex(triangles[t].x));
    mesh.corner1.push_back(vertex(triangles[t].y));
    mesh.corner2.push_back(vertex(triangles[t].z));
  }
  const auto nothing = static_cast<std::int32_t>(mesh.corner0.size());
  for (const MeshEdge& edge : topology.edges) {
    mesh.edge_from.push_back(vertex(edge.from));
    mesh.edge_to.push_back(vertex(edge.to));
    mesh.edge_first.push_back(kept[edge.triangles[0]]);
    mesh.edge_second.push_back(edge.count == 2 ? kept[edge.triangles[1]] : nothing);
    mesh.edge_winding.push_back(edge.forward == 1 ? 1.0f : -1.0f);
    if (edge.count > 2) mesh.edge_first.back() = nothing + 1;  // always a contour
  }
  mesh.vertex_count = static_cast<std::uint32_t>(mesh.x.size());
  mesh.triangle_count = static_cast<std::uint32_t>(mesh.corner0.size());
  mesh.edge_count = static_cast<std::uint32_t>(mesh.edge_from.size());
  for (auto* array : {&mesh.x, &mesh.y, &mesh.z, &mesh.edge_winding}) pad(*array, 0.0f);
  for (auto* array : {&mesh.corner0, &mesh.corner1, &mesh.corner2, &mesh.edge_from, &mesh.edge_to}) pad(*array, 0);
  for (auto* array : {&mesh.edge_first, &mesh.edge_second}) pad(*array, nothing);
  return mesh;
}

}  // namespace sightline
