#include "sightline/geometry/cluster_tree.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "sightline/geometry/cluster_walk.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sightline/geometry/cluster_tree.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Bits of the children that turn back (low byte) and front (high byte).
HWY_INLINE std::uint32_t test_children(const ClusterNode& node, const glm::vec4& eye, float slack, float sharpness) {
  const hn::CappedTag<float, ClusterNode::width> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto w = hn::Set(d, eye.w);
  std::uint32_t back = 0, front = 0;
  for (std::size_t k = 0; k < ClusterNode::width; k += lanes) {
    auto most = hn::Zero(d), least = hn::Zero(d), along = hn::Zero(d), square = hn::Zero(d);
    for (int axis = 0; axis < 3; ++axis) {
      const auto v = hn::Sub(hn::Set(d, eye[axis]), hn::Mul(hn::LoadU(d, node.c[axis] + k), w));
      const auto low = hn::Mul(hn::LoadU(d, node.n[axis] + k), v), high = hn::Mul(hn::LoadU(d, node.m[axis] + k), v);
      most = hn::Add(most, hn::Max(low, high));
      least = hn::Add(least, hn::Min(low, high));
      along = hn::Add(along, hn::Mul(hn::LoadU(d, node.axis[axis] + k), v));
      square = hn::Add(square, hn::Mul(v, v));
    }
    const auto wide = hn::Mul(hn::LoadU(d, node.radius + k), hn::Sqrt(square));
    most = hn::Min(most, hn::Add(along, wide));
    least = hn::Max(least, hn::Sub(along, wide));
    const auto limit = hn::Add(hn::Set(d, slack), hn::Mul(hn::Set(d, sharpness), hn::LoadU(d, node.sharpness + k)));
    const auto behind = hn::Sub(most, hn::Mul(hn::LoadU(d, node.d + k), w));
    const auto before = hn::Sub(least, hn::Mul(hn::LoadU(d, node.front + k), w));
    std::uint8_t back_bits[8] = {}, front_bits[8] = {};
    hn::StoreMaskBits(d, hn::Le(behind, hn::Neg(limit)), back_bits);
    hn::StoreMaskBits(d, hn::Gt(before, hn::Zero(d)), front_bits);
    back |= static_cast<std::uint32_t>(back_bits[0]) << k;
    front |= static_cast<std::uint32_t>(front_bits[0]) << k;
  }
  return (back & 0xFFu) | ((front & 0xFFu) << 8);
}

void front_clusters_simd(const ClusterTree& tree, const glm::vec4& eye, float slack, float sharpness,
                         std::span<std::uint64_t> kept, ClusterCounts& counts) {
  walk_clusters(tree, kept, counts,
                [&](const ClusterNode& node) { return test_children(node, eye, slack, sharpness); });
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {
namespace {

/// A node of the binary tree from which the wide one is made.
struct Part {
  std::uint32_t begin, end;
  std::uint32_t left = 0, right = 0;  // 0: a leaf
  Aabb bounds{};
  NormalCluster cluster{};
};

struct Build {
  const ClusterTreeConfig& config;
  std::vector<FacePlane> planes;  // by triangle
  std::vector<Aabb> boxes;        // by triangle
  std::vector<std::uint32_t> order;
  double size;         // of the mesh
  std::uint32_t leaf;  // triangles
  std::vector<Part> parts;
  std::vector<FacePlane> gathered;
};

std::array<double, 6> features(const Build& build, std::uint32_t triangle) {
  const glm::dvec3& n = build.planes[triangle].normal;
  const glm::dvec3 p = glm::dvec3(build.boxes[triangle].centre()) * (build.config.position / build.size);
  return {n.x, n.y, n.z, p.x, p.y, p.z};
}

/// Where to part a range: the first place of the right half. Both halves hold at least one triangle.
std::uint32_t part_range(Build& build, std::uint32_t begin, std::uint32_t end, int depth) {
  std::array<double, 6> low{}, high{}, sum{};
  low.fill(1e300);
  high.fill(-1e300);
  for (std::uint32_t i = begin; i < end; ++i) {
    const std::array<double, 6> f = features(build, build.order[i]);
    for (std::size_t k = 0; k < 6; ++k) {
      low[k] = std::min(low[k], f[k]);
      high[k] = std::max(high[k], f[k]);
      sum[k] += f[k];
    }
  }
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 6; ++k)
    if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
  const double at = sum[axis] / (end - begin);
  const auto first = build.order.begin();
  auto middle =
      std::stable_partition(first + begin, first + end, [&](std::uint32_t t) { return features(build, t)[axis] < at; });
  auto place = static_cast<std::uint32_t>(middle - first);
  return place == begin || place == end || depth > 48 ? begin + (end - begin) / 2 : place;
}

/// Radical inverse of i: evenly spread numbers in [0, 1) that are the same everywhere.
double spread(int i, int base) {
  double result = 0.0, step = 1.0;
  for (; i > 0; i /= base) {
    step /= base;
    result += step * (i % base);
  }
  return result;
}

/// Of how many viewpoints around the mesh the cluster is culled: what counts in the end, box and cone together.
int culled_from(const NormalCluster& cluster, double size) {
  int culled = 0;
  for (int i = 1; i <= 64; ++i) {
    const glm::vec3 eye(3.0 * size * (glm::dvec3(spread(i, 2), spread(i, 3), spread(i, 5)) - 0.5));
    culled += turns_back(cluster, glm::vec4(eye, 1.0f), 0.0f) ? 1 : 0;
  }
  return culled;
}

/// Adds the cone, and takes its apex as local origin where that is culled more often.
void improve(const Build& build, Part& part) {
  add_cone(part.cluster, build.gathered);
  const glm::dvec3 apex = cone_apex(part.cluster, build.gathered, part.bounds);
  // The slack of the test is made for origins within the mesh's bounds.
  if (part.cluster.radius >= NormalCluster::no_cone || glm::length(apex) > 0.5 * build.size) return;
  NormalCluster other = make_cluster(build.gathered, glm::vec3(apex));
  other.axis = part.cluster.axis;
  other.radius = part.cluster.radius;
  if (culled_from(other, build.size) > culled_from(part.cluster, build.size)) part.cluster = other;
}

std::uint32_t build_part(Build& build, std::uint32_t begin, std::uint32_t end, int depth = 0) {
  const auto index = static_cast<std::uint32_t>(build.parts.size());
  build.parts.push_back({begin, end});
  Part part{begin, end};
  for (std::uint32_t i = begin; i < end; ++i) part.bounds.extend(build.boxes[build.order[i]]);
  if (end - begin > build.leaf) {
    const std::uint32_t middle = part_range(build, begin, end, depth);
    part.left = build_part(build, begin, middle, depth + 1);
    part.right = build_part(build, middle, end, depth + 1);
  }
  build.gathered.clear();
  for (std::uint32_t i = begin; i < end; ++i) build.gathered.push_back(build.planes[build.order[i]]);
  const Aabb viewpoints = near_field(part.bounds, build.config.near_field);
  part.cluster = build.config.origins ? best_cluster(build.gathered, part.bounds, viewpoints)
                                      : make_cluster(build.gathered, part.bounds.centre());
  if (build.config.cone) improve(build, part);
  const ClusterCost cost{build.config.cost_test};
  if (part.left != 0 && build.parts[part.left].left == 0 && build.parts[part.right].left == 0) {
    const Part &a = build.parts[part.left], &b = build.parts[part.right];
    const double threshold = cost.merge_threshold(
        culling_probability(a.cluster, near_field(a.bounds, build.config.near_field)), a.end - a.begin,
        culling_probability(b.cluster, near_field(b.bounds, build.config.near_field)), b.end - b.begin);
    if (build.config.cost_test > 0.0 && culling_probability(part.cluster, viewpoints) > threshold)
      part.left = part.right = 0;
  }
  build.parts[index] = part;
  return index;
}

void put(ClusterNode& node, std::size_t k, const Part& part) {
  for (int axis = 0; axis < 3; ++axis) {
    node.n[axis][k] = part.cluster.n[axis];
    node.m[axis][k] = part.cluster.m[axis];
    node.c[axis][k] = part.cluster.c[axis];
    node.axis[axis][k] = part.cluster.axis[axis];
  }
  node.d[k] = part.cluster.d;
  node.front[k] = part.cluster.front;
  node.sharpness[k] = part.cluster.sharpness;
  node.radius[k] = part.cluster.radius;
  node.begin[k] = part.begin;
  node.end[k] = part.end;
  node.child[k] = ClusterNode::leaf;
}

/// Opens the largest of up to eight parts until there are eight or only leaves; then each inner one becomes a node.
std::uint32_t make_node(const Build& build, const std::vector<std::uint32_t>& top, ClusterTree& tree) {
  std::vector<std::uint32_t> list = top;
  while (list.size() < ClusterNode::width) {
    const auto open = std::max_element(list.begin(), list.end(), [&](std::uint32_t a, std::uint32_t b) {
      const auto size = [&](const Part& p) { return p.left == 0 ? 0u : p.end - p.begin; };
      return size(build.parts[a]) < size(build.parts[b]);
    });
    const Part& part = build.parts[*open];
    if (part.left == 0) break;
    *open = part.left;
    list.insert(open + 1, part.right);
  }
  const auto index = static_cast<std::uint32_t>(tree.nodes.size());
  tree.nodes.push_back(ClusterNode{});
  tree.nodes[index].count = static_cast<std::uint32_t>(list.size());
  for (std::size_t k = 0; k < list.size(); ++k) {
    const Part& part = build.parts[list[k]];
    put(tree.nodes[index], k, part);
    ++tree.clusters;
    if (part.left == 0) {
      ++tree.leaves;
      continue;
    }
    const std::uint32_t child = make_node(build, {part.left, part.right}, tree);
    tree.nodes[index].child[k] = child;
  }
  return index;
}

}  // namespace

HWY_EXPORT(front_clusters_simd);

ClusterTree build_cluster_tree(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                               const glm::vec3& origin, const ClusterTreeConfig& config) {
  ClusterTree tree;
  if (triangles.empty()) return tree;
  Build build{config, {}, {}, std::vector<std::uint32_t>(triangles.size()), 0.0, 0, {}, {}};
  std::iota(build.order.begin(), build.order.end(), 0u);
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
  build.size = std::max(1e-30, static_cast<double>(glm::length(all.extent())));
  // A whole small solid never turns its back: it needs clusters of its own scale.
  build.leaf = static_cast<std::uint32_t>(
      std::clamp<std::size_t>(triangles.size() / 24, 2, static_cast<std::size_t>(std::max(config.leaf, 2))));
  if (config.leaf == 1) build.leaf = 1;
  // Triangles without area are in clusters of their own, so that they do not spoil any.
  const auto flat = std::stable_partition(build.order.begin(), build.order.end(),
                                          [&](std::uint32_t t) { return build.planes[t].height > 0.0; });
  const auto solid = static_cast<std::uint32_t>(flat - build.order.begin());
  const auto count = static_cast<std::uint32_t>(triangles.size());
  std::vector<std::uint32_t> top;
  if (solid > 0) top.push_back(build_part(build, 0, solid));
  if (solid < count) {
    top.push_back(static_cast<std::uint32_t>(build.parts.size()));
    Part rest{solid, count};
    rest.cluster.sharpness = std::numeric_limits<float>::infinity();
    build.parts.push_back(rest);
  }
  make_node(build, top, tree);
  tree.order = std::move(build.order);
  return tree;
}

void front_clusters(const ClusterTree& tree, const glm::vec4& eye, float slack, float sharpness,
                    std::span<std::uint64_t> kept, ClusterCounts& counts) {
  HWY_DYNAMIC_DISPATCH(front_clusters_simd)(tree, eye, slack, sharpness, kept, counts);
}

namespace {

NormalCluster cluster_at(const ClusterNode& node, std::size_t k) {
  NormalCluster cluster;
  for (int axis = 0; axis < 3; ++axis) {
    cluster.n[axis] = node.n[axis][k];
    cluster.m[axis] = node.m[axis][k];
    cluster.c[axis] = node.c[axis][k];
    cluster.axis[axis] = node.axis[axis][k];
  }
  cluster.d = node.d[k];
  cluster.front = node.front[k];
  cluster.sharpness = node.sharpness[k];
  cluster.radius = node.radius[k];
  return cluster;
}

}  // namespace

void front_clusters_scalar(const ClusterTree& tree, const glm::vec4& eye, float slack, float sharpness,
                           std::span<std::uint64_t> kept, ClusterCounts& counts) {
  walk_clusters(tree, kept, counts, [&](const ClusterNode& node) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < ClusterNode::width; ++k) {
      const NormalCluster cluster = cluster_at(node, k);
      if (turns_back(cluster, eye, slack + sharpness * cluster.sharpness)) bits |= 1u << k;
      if (turns_front(cluster, eye)) bits |= 0x100u << k;
    }
    return bits;
  });
}

std::vector<ClusterRange> leaf_clusters(const ClusterTree& tree) {
  std::vector<ClusterRange> leaves;
  for (const ClusterNode& node : tree.nodes)
    for (std::size_t k = 0; k < ClusterNode::width; ++k)
      if (node.child[k] == ClusterNode::leaf && node.begin[k] < node.end[k])
        leaves.push_back({cluster_at(node, k), node.begin[k], node.end[k]});
  return leaves;
}

}  // namespace sightline
#endif
