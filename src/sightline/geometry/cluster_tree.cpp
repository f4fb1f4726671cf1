#include "sightline/geometry/cluster_tree.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "sightline/geometry/cluster_walk.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sightline/geometry/cluster_tree.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

HWY_INLINE NodeSides test_node(const ClusterNode& node, const glm::vec4& eye, float slack, float sharpness) {
  const hn::CappedTag<float, ClusterNode::width> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto w = hn::Set(d, eye.w);
  NodeSides sides{0, 0};
  for (std::size_t k = 0; k < ClusterNode::width; k += lanes) {
    auto most = hn::Zero(d), least = hn::Zero(d);
    for (int axis = 0; axis < 3; ++axis) {
      const auto v = hn::Sub(hn::Set(d, eye[axis]), hn::Mul(hn::LoadU(d, node.c[axis] + k), w));
      const auto low = hn::Mul(hn::LoadU(d, node.n[axis] + k), v), high = hn::Mul(hn::LoadU(d, node.m[axis] + k), v);
      most = hn::Add(most, hn::Max(low, high));
      least = hn::Add(least, hn::Min(low, high));
    }
    const auto limit = hn::Add(hn::Set(d, slack), hn::Mul(hn::Set(d, sharpness), hn::LoadU(d, node.sharpness + k)));
    const auto behind = hn::Sub(most, hn::Mul(hn::LoadU(d, node.d + k), w));
    const auto before = hn::Sub(least, hn::Mul(hn::LoadU(d, node.front + k), w));
    std::uint8_t back[8] = {}, front[8] = {};
    hn::StoreMaskBits(d, hn::Le(behind, hn::Neg(limit)), back);
    hn::StoreMaskBits(d, hn::Gt(before, hn::Zero(d)), front);
    sides.back |= static_cast<std::uint32_t>(back[0]) << k;
    sides.front |= static_cast<std::uint32_t>(front[0]) << k;
  }
  return sides;
}

void front_clusters_simd(const ClusterTree& tree, const glm::vec4& eye, float slack, float sharpness,
                         std::span<std::uint64_t> kept, ClusterCounts& counts) {
  walk_clusters(tree, kept, counts, [&](const ClusterNode& node) { return test_node(node, eye, slack, sharpness); });
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
namespace {

constexpr std::uint32_t width = ClusterNode::width;

struct Build {
  const ClusterTreeConfig& config;
  std::uint32_t leaf = 1;                      // triangles
  std::vector<FacePlane> planes;               // by triangle
  std::vector<Aabb> boxes;                     // by triangle
  std::vector<std::array<float, 6>> features;  // by triangle: normal, and place by its weight
  std::vector<std::uint32_t> order;
};

/// A whole small solid never turns its back: it needs clusters of its own scale.
std::uint32_t leaf_size(std::size_t triangles, const ClusterTreeConfig& config) {
  const auto most = static_cast<std::size_t>(std::max(config.leaf, 1));
  return static_cast<std::uint32_t>(
      std::bit_floor(std::clamp<std::size_t>(triangles / 24, std::min(most, size_t{2}), most)));
}

/// Puts triangles that are much thinner than most last; returns how many are before them, a multiple of the leaf.
std::uint32_t set_thin_apart(Build& build) {
  std::vector<std::uint32_t>& order = build.order;
  const auto height = [&](std::uint32_t t) { return build.planes[t].height; };
  const auto thicker = [&](std::uint32_t a, std::uint32_t b) {
    return height(a) != height(b) ? height(a) > height(b) : a < b;
  };
  const auto count = static_cast<std::ptrdiff_t>(order.size());
  std::nth_element(order.begin(), order.begin() + count / 2, order.end(), thicker);
  const double thin = 0.25 * height(order[static_cast<std::size_t>(count / 2)]);
  const auto below = [&](double limit) {
    return std::count_if(order.begin(), order.end(), [&](std::uint32_t t) { return !(height(t) > limit); });
  };
  const std::ptrdiff_t apart = std::max(std::min(below(thin), count / 16), below(0.0));
  const std::ptrdiff_t before = (count - apart) / build.leaf * build.leaf;
  if (before < count) std::nth_element(order.begin(), order.begin() + before, order.end(), thicker);
  return static_cast<std::uint32_t>(before);
}

/// Orders a range of places so that clusters of every level are compact: cut near the middle, at a border of the
/// largest clusters that fit.
void part(Build& build, std::uint32_t begin, std::uint32_t end) {
  const std::uint32_t count = end - begin;
  if (count <= build.leaf) return;
  std::array<double, 6> sum{}, square{};
  for (std::uint32_t i = begin; i < end; ++i)
    for (std::size_t k = 0; k < 6; ++k) {
      const auto f = static_cast<double>(build.features[build.order[i]][k]);
      sum[k] += f;
      square[k] += f * f;
    }
  const auto varies = [&](std::size_t k) { return square[k] - sum[k] * sum[k] / count; };
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 6; ++k)
    if (varies(k) > varies(axis)) axis = k;
  std::uint32_t unit = build.leaf;
  while (count / width > unit) unit *= width;
  const std::uint32_t middle = begin + std::clamp((count / 2 + unit / 2) / unit, 1u, (count - 1) / unit) * unit;
  std::nth_element(build.order.begin() + begin, build.order.begin() + middle, build.order.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const float fa = build.features[a][axis], fb = build.features[b][axis];
                     return fa != fb ? fa < fb : a < b;
                   });
  part(build, begin, middle);
  part(build, middle, end);
}

void put(ClusterNode& node, std::uint32_t k, const NormalCluster& cluster) {
  for (int axis = 0; axis < 3; ++axis) {
    node.n[axis][k] = cluster.n[axis];
    node.m[axis][k] = cluster.m[axis];
    node.c[axis][k] = cluster.c[axis];
  }
  node.d[k] = cluster.d;
  node.front[k] = cluster.front;
  node.sharpness[k] = cluster.sharpness;
}

/// A level of clusters of `size` triangles. `costs`: T of each cluster of the level below, replaced by those of this
/// one (19.14); empty below the leaves.
std::vector<ClusterNode> make_level(const Build& build, std::size_t size, std::vector<double>& costs) {
  const std::size_t clusters = (build.order.size() + size - 1) / size;
  const ClusterCost cost{build.config.cost_test};
  std::vector<ClusterNode> level((clusters + width - 1) / width);
  std::vector<double> own(clusters);
  std::vector<FacePlane> planes;
  for (std::size_t i = 0; i < clusters; ++i) {
    planes.clear();
    Aabb bounds;
    for (std::size_t place = i * size; place < std::min((i + 1) * size, build.order.size()); ++place) {
      planes.push_back(build.planes[build.order[place]]);
      bounds.extend(build.boxes[build.order[place]]);
    }
    const Aabb viewpoints = near_field(bounds, build.config.near_field);
    const NormalCluster cluster =
        build.config.origins ? best_cluster(planes, bounds, viewpoints) : make_cluster(planes, bounds.centre());
    ClusterNode& node = level[i / width];
    put(node, i % width, cluster);
    node.used |= static_cast<std::uint8_t>(1u << (i % width));
    own[i] = cost.of(culling_probability(cluster, viewpoints), static_cast<double>(planes.size()));
    if (costs.empty()) continue;
    const auto first = costs.begin() + static_cast<std::ptrdiff_t>(width * i);
    const double parts = std::accumulate(first, std::min(first + width, costs.end()), 0.0);
    if (build.config.cost_test > 0.0 && own[i] < parts)
      node.whole |= static_cast<std::uint8_t>(1u << (i % width));
    else
      own[i] = parts;
  }
  costs = std::move(own);
  return level;
}

NormalCluster cluster_at(const ClusterNode& node, std::size_t k) {
  NormalCluster cluster;
  for (int axis = 0; axis < 3; ++axis) {
    cluster.n[axis] = node.n[axis][k];
    cluster.m[axis] = node.m[axis][k];
    cluster.c[axis] = node.c[axis][k];
  }
  cluster.d = node.d[k];
  cluster.front = node.front[k];
  cluster.sharpness = node.sharpness[k];
  return cluster;
}

/// Visits the clusters that a walk can reach, from the top: visit(level, index, is a leaf).
template <class Visit>
void each_cluster(const ClusterTree& tree, std::size_t level, std::size_t node, const Visit& visit) {
  const ClusterNode& at = tree.levels[level][node];
  for (std::size_t k = 0; k < width; ++k) {
    if (((at.used >> k) & 1) == 0) continue;
    const bool leaf = level == 0 || ((at.whole >> k) & 1) != 0;
    visit(level, node * width + k, leaf);
    if (!leaf) each_cluster(tree, level - 1, node * width + k, visit);
  }
}

}  // namespace

HWY_EXPORT(front_clusters_simd);

ClusterTree build_cluster_tree(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                               const glm::vec3& origin, const ClusterTreeConfig& config) {
  ClusterTree tree;
  if (triangles.empty()) return tree;
  Build build{config, leaf_size(triangles.size(), config), {}, {}, {}, {}};
  const glm::dvec3 shift(origin);
  Aabb all;
  for (const glm::uvec3& t : triangles) {
    Aabb box;
    for (int k = 0; k < 3; ++k) box.extend(positions[t[k]] - origin);
    build.boxes.push_back(box);
    all.extend(box);
    build.planes.push_back(face_plane(glm::dvec3(positions[t.x]) - shift, glm::dvec3(positions[t.y]) - shift,
                                      glm::dvec3(positions[t.z]) - shift));
  }
  const double scale = config.position / std::max(1e-30, static_cast<double>(glm::length(all.extent())));
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const glm::vec3 n(build.planes[t].normal), p(glm::dvec3(build.boxes[t].centre()) * scale);
    build.features.push_back({n.x, n.y, n.z, p.x, p.y, p.z});
  }
  const auto count = static_cast<std::uint32_t>(triangles.size());
  build.order.resize(count);
  std::iota(build.order.begin(), build.order.end(), 0u);
  const std::uint32_t thick = set_thin_apart(build);
  part(build, 0, thick);
  part(build, thick, count);
  tree.leaf = build.leaf;
  std::vector<double> costs;
  for (std::size_t size = build.leaf; tree.levels.empty() || tree.levels.back().size() > 1; size *= width)
    tree.levels.push_back(make_level(build, size, costs));
  tree.order = std::move(build.order);
  each_cluster(tree, tree.levels.size() - 1, 0, [&](std::size_t, std::size_t, bool leaf) {
    ++tree.clusters;
    tree.leaves += leaf ? 1 : 0;
  });
  return tree;
}

void front_clusters(const ClusterTree& tree, const glm::vec4& eye, float slack, float sharpness,
                    std::span<std::uint64_t> kept, ClusterCounts& counts) {
  HWY_DYNAMIC_DISPATCH(front_clusters_simd)(tree, eye, slack, sharpness, kept, counts);
}

void front_clusters_scalar(const ClusterTree& tree, const glm::vec4& eye, float slack, float sharpness,
                           std::span<std::uint64_t> kept, ClusterCounts& counts) {
  walk_clusters(tree, kept, counts, [&](const ClusterNode& node) {
    NodeSides sides{0, 0};
    for (std::size_t k = 0; k < width; ++k) {
      const NormalCluster cluster = cluster_at(node, k);
      if (turns_back(cluster, eye, slack + sharpness * cluster.sharpness)) sides.back |= 1u << k;
      if (turns_front(cluster, eye)) sides.front |= 1u << k;
    }
    return sides;
  });
}

std::vector<ClusterRange> leaf_clusters(const ClusterTree& tree) {
  std::vector<ClusterRange> leaves;
  if (tree.levels.empty()) return leaves;
  each_cluster(tree, tree.levels.size() - 1, 0, [&](std::size_t level, std::size_t i, bool leaf) {
    if (!leaf) return;
    const std::size_t size = std::size_t{tree.leaf} << (3 * level);
    leaves.push_back({cluster_at(tree.levels[level][i / width], i % width), static_cast<std::uint32_t>(i * size),
                      static_cast<std::uint32_t>(std::min((i + 1) * size, tree.order.size()))});
  });
  return leaves;
}

}  // namespace sightline
#endif
