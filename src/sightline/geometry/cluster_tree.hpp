// A hierarchy of clusters of triangles that turn their backs or faces as one (Kumar, Manocha, Garrett, Lin 1996;
// checklist 19.10-19.16): plain data, a builder for any mesh, and a walk with early stop. Conservative.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/geometry/normal_cluster.hpp"

namespace sightline {

/// Eight children at once, as arrays: what a SIMD test wants.
struct ClusterNode {
  static constexpr std::size_t width = 8;
  static constexpr std::uint32_t leaf = 0xFFFFFFFFu;
  float n[3][width], m[3][width], c[3][width], d[width], front[width], sharpness[width], axis[3][width], radius[width];
  std::uint32_t begin[width], end[width];  // places of the triangles
  std::uint32_t child[width];              // node, or `leaf`
  std::uint32_t count;                     // children in use
};

struct ClusterTree {
  std::vector<ClusterNode> nodes;    // nodes[0] is the root; empty if there are no triangles
  std::vector<std::uint32_t> order;  // triangle at each place; every cluster is a range of places
  std::uint32_t clusters = 0, leaves = 0;
};

struct ClusterTreeConfig {
  int leaf = 128;           // triangles: clusters of at most so many (or 1/24 of the mesh) are not cut, 1 to 4096
  double cost_test = 4.0;   // t_C / r of the cost model; 0 keeps all leaves apart
  double position = 1.2;    // weight of place against direction where triangles are parted, >= 0
  float near_field = 4.0f;  // the viewpoints of the cost model: box of the cluster times this, > 1
  bool origins = true;      // the best of nine local origins, or the centre (19.08)
  bool cone = true;         // bound the normals by a cone as well, and try its apex as origin
};

/// Positions minus `origin`. Triangles are parted at the mean of the widest of normal and place, from the top; then,
/// from the bottom up, two leaves become one where the cost model says so. Deterministic.
ClusterTree build_cluster_tree(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                               const glm::vec3& origin, const ClusterTreeConfig& config = {});

struct ClusterCounts {
  std::uint64_t tested = 0;  // clusters
  std::uint64_t culled = 0;  // triangles
};

/// Sets the bits of all places but those of clusters that turn their backs for sure by more than slack + sharpness *
/// cluster.sharpness. Stops at clusters that are wholly back or front.
void front_clusters(const ClusterTree& tree, const glm::vec4& eye, float slack, float sharpness,
                    std::span<std::uint64_t> kept, ClusterCounts& counts);
void front_clusters_scalar(const ClusterTree& tree, const glm::vec4& eye, float slack, float sharpness,
                           std::span<std::uint64_t> kept, ClusterCounts& counts);

/// The leaves as single clusters with their ranges of places.
struct ClusterRange {
  NormalCluster cluster;
  std::uint32_t begin, end;
};
std::vector<ClusterRange> leaf_clusters(const ClusterTree& tree);

}  // namespace sightline
