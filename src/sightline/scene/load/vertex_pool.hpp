// Vertices that several meshes of a file draw from, such as the one list of an OBJ or a shared glTF buffer.
#pragma once

#include <cstdint>
#include <vector>

#include "sightline/scene/scene.hpp"

namespace sightline {

class VertexPool {
 public:
  explicit VertexPool(std::vector<glm::vec3> points) : points_(std::move(points)) {}

  [[nodiscard]] std::size_t size() const { return points_.size(); }

  /// A mesh of `triangles` (indices below size()) with the vertices they use and no other, in the order of the pool.
  /// Work goes with the triangles, not with the size of the pool.
  Mesh mesh_of(std::vector<glm::uvec3> triangles);

 private:
  std::vector<glm::vec3> points_;
  std::vector<std::uint32_t> new_index_;  // of a vertex in the mesh that is being made
  std::vector<std::uint32_t> seen_by_;    // number of the last mesh that used the vertex
  std::uint32_t meshes_ = 0;
};

}  // namespace sightline
