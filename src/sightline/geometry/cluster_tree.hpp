// A hierarchy of clusters of triangles that turn their backs or faces as one (Kumar, Manocha, Garrett, Lin 1996;
// checklist 19.10-19.16): plain data, a builder for any mesh, and a walk with early stop. Conservative.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/geometry/normal_cluster.hpp"

namespace sightline {

/// Eight clusters at once, as arrays: what a SIMD test wants. One bit of `used` and `whole` for each.
struct ClusterNode {
  static constexpr std::size_t width = 8;
  float n[3][width], m[3][width], c[3][width], d[width], front[width], sharpness[width];
  std::uint8_t used = 0;   // there is such a cluster
  std::uint8_t whole = 0;  // not worth opening: the cost model's merge
};

/// All clusters of a level hold the same number of triangles (but the last, which may hold fewer), eight times those of
/// the level below. So cluster i is child i % 8 of node i / 8, and node i of the level below holds its parts.
struct ClusterTree {
  std::uint32_t leaf = 1;                        // triangles of a cluster of levels[0]: a power of two
  std::vector<std::vector<ClusterNode>> levels;  // the last one is a single node; empty if there are no triangles
  std::vector<std::uint32_t> order;        // triangle at each place; cluster i of level l: [i, i + 1) * leaf * 8^l
  std::uint32_t clusters = 0, leaves = 0;  // that a walk can reach; that it never opens
};

struct ClusterTreeConfig {
  int leaf = 256;           // triangles of the smallest clusters (or 1/24 of the mesh), rounded down to a power of two
  double cost_test = 4.0;   // t_C / r of the cost model; 0 merges nothing
  double position = 0.6;    // weight of place against direction where triangles are parted, >= 0
  float near_field = 4.0f;  // the viewpoints of the cost model: box of the cluster times this, > 1
  bool origins = true;      // the best of nine local origins, or the centre (19.08)
};

/// Positions minus `origin`. Triangles are parted near the median of normal or place, whichever varies most, down to
/// the leaves. The thinnest ones, whose thinness would count for all that share a cluster with them, are set apart.
/// Then eight clusters become one wherever that costs less (19.15 with E39).
ClusterTree build_cluster_tree(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                               const glm::vec3& origin, const ClusterTreeConfig& config = {});

struct ClusterCounts {
  std::uint64_t tested = 0;  // clusters
  std::uint64_t culled = 0;  // triangles
};

/// Sets the bits of all places but those of clusters that turn their backs for sure by more than slack + sharpness *
/// cluster.sharpness. Stops at clusters that are wholly back or front. `kept`: one bit for each triangle, all clear.
void front_clusters(const ClusterTree& tree, const glm::vec4& eye, float slack, float sharpness,
                    std::span<std::uint64_t> kept, ClusterCounts& counts);
void front_clusters_scalar(const ClusterTree& tree, const glm::vec4& eye, float slack, float sharpness,
                           std::span<std::uint64_t> kept, ClusterCounts& counts);

/// The leaves (clusters that are never opened) as single clusters with their ranges of places.
struct ClusterRange {
  NormalCluster cluster;
  std::uint32_t begin, end;
};
std::vector<ClusterRange> leaf_clusters(const ClusterTree& tree);

}  // namespace sightline
