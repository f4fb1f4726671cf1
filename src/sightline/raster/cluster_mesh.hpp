// A mesh cut into clusters of neighbouring triangles with their own vertices and bounds: the unit in which the tile
// rasteriser culls, transforms and draws. Plain data; built once for each mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "sightline/scene/scene.hpp"

namespace sightline::raster {

inline constexpr std::uint32_t cluster_triangles = 128;  // most in one cluster; ids keep 7 bits for them
inline constexpr std::uint32_t cluster_vertices = 192;   // most in one cluster; indices are bytes
inline constexpr std::size_t cluster_padding = 16;       // entries that loops may read beyond the end of an array

/// Triangles [first_triangle, first_triangle + triangles) of the mesh.
struct Cluster {
  std::uint32_t first_triangle, triangles;
  std::uint32_t vertex_offset, vertices;  // into x, y, z
  std::uint32_t index_offset;             // into a, b, c; padded with triangles without area
};

struct ClusterMesh {
  std::vector<float> x, y, z;         // vertices of all clusters, mesh space
  std::vector<std::uint8_t> a, b, c;  // corners, counted from the cluster's first vertex
  std::vector<Cluster> clusters;
  // Bounds of each cluster, structure of arrays, padded by empty ones.
  std::vector<float> low_x, low_y, low_z, high_x, high_y, high_z;
  Aabb bounds;
};

/// Triangles stay in the order of the mesh, so clusters are as compact as that order is coherent.
ClusterMesh make_clusters(const Mesh& mesh);

}  // namespace sightline::raster
