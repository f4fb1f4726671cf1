// Small meshes whose topology is known.
#pragma once

#include <cmath>

#include "sightline/scene/scene.hpp"

namespace sightline::shapes {

/// The unit cube: 8 vertices (corner i as in Aabb::corner), 12 triangles, outside counter-clockwise.
inline Mesh cube() {
  Mesh mesh;
  mesh.name = "cube";
  for (int i = 0; i < 8; ++i) mesh.positions.push_back(Aabb{glm::vec3(0), glm::vec3(1)}.corner(i));
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// The same surface with three vertices of its own for every triangle.
inline Mesh split_vertices(const Mesh& mesh) {
  Mesh result;
  result.name = mesh.name;
  for (const glm::uvec3& t : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(result.positions.size());
    for (int k = 0; k < 3; ++k) result.positions.push_back(mesh.positions[t[k]]);
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

/// A band of n quads with half a turn: one boundary curve, no orientation.
inline Mesh moebius_strip(std::uint32_t n) {
  Mesh mesh;
  mesh.name = "moebius strip";
  for (std::uint32_t i = 0; i < n; ++i) {
    const float angle = 6.2831853f * static_cast<float>(i) / static_cast<float>(n);
    const glm::vec3 centre(std::cos(angle), 0, std::sin(angle));
    const glm::vec3 across = 0.2f * (std::cos(angle / 2) * centre + std::sin(angle / 2) * glm::vec3(0, 1, 0));
    mesh.positions.push_back(centre - across);
    mesh.positions.push_back(centre + across);
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const bool last = i + 1 == n;  // the last quad joins the first with its sides exchanged
    const std::uint32_t a = 2 * i, b = 2 * i + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({c, b, d});
  }
  return mesh;
}

}  // namespace sightline::shapes
