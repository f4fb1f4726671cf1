#include "sightline/scene/load/vertex_pool.hpp"

#include <algorithm>
#include <utility>

namespace sightline {

Mesh VertexPool::mesh_of(std::vector<glm::uvec3> triangles) {
  new_index_.resize(points_.size());
  seen_by_.resize(points_.size());
  const std::uint32_t number = ++meshes_;
  std::vector<std::uint32_t> used;
  for (const glm::uvec3& triangle : triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t vertex = triangle[corner];
      if (std::exchange(seen_by_[vertex], number) != number) used.push_back(vertex);
    }
  }
  std::ranges::sort(used);
  Mesh mesh;
  mesh.positions.reserve(used.size());
  for (const std::uint32_t vertex : used) {
    new_index_[vertex] = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(points_[vertex]);
  }
  for (glm::uvec3& triangle : triangles) {
    for (int corner = 0; corner < 3; ++corner) triangle[corner] = new_index_[triangle[corner]];
  }
  mesh.triangles = std::move(triangles);
  return mesh;
}

}  // namespace sightline
