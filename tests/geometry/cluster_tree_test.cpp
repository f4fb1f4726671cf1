// The hierarchy of clusters: every triangle once, SIMD against scalar, early stops counted, deep and flat input.
#include "sightline/geometry/cluster_tree.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/generate/shapes.hpp"

namespace sightline {
namespace {

TEST(ClusterTree, EveryTriangleIsInOneLeaf) {
  for (const int leaf : {1, 7, 64, 128, 4096})
    for (const int columns : {3, 5, 50, 211}) {
      const Mesh ball = make_ball(columns, 30);
      ClusterTreeConfig config;
      config.leaf = leaf;
      const ClusterTree tree = build_cluster_tree(ball.positions, ball.triangles, {}, config);
      EXPECT_LE(tree.leaf, static_cast<std::uint32_t>(leaf));
      std::vector<int> seen(ball.triangles.size());
      for (const std::uint32_t t : tree.order) ++seen[t];
      for (const int count : seen) EXPECT_EQ(count, 1);
      std::vector<int> covered(ball.triangles.size());
      for (const ClusterRange& range : leaf_clusters(tree))
        for (std::uint32_t i = range.begin; i < range.end; ++i) ++covered[i];
      for (const int count : covered) EXPECT_EQ(count, 1);
      EXPECT_EQ(leaf_clusters(tree).size(), tree.leaves);
      EXPECT_EQ(tree.levels.back().size(), 1u);
    }
}

/// A cluster of every level bounds its own triangles, and the walk's answer is that of its clusters, leaf by leaf.
TEST(ClusterTree, KeepsExactlyWhatNoClusterOnTheWayCulls) {
  Random random(8);
  Mesh mesh = make_ball(70, 41);
  for (glm::vec3& p : mesh.positions) p *= static_cast<float>(random.range(0.95, 1.05));
  for (const int leaf : {1, 8, 32, 64, 256}) {
    ClusterTreeConfig config;
    config.leaf = leaf;
    const ClusterTree tree = build_cluster_tree(mesh.positions, mesh.triangles, {}, config);
    for (int i = 0; i < 20; ++i) {
      const glm::vec4 eye(glm::vec3(random.range(1.5, 20) * random.direction()), 1.0f);
      std::vector<std::uint64_t> kept((mesh.triangles.size() + 63) / 64);
      ClusterCounts counts;
      front_clusters(tree, eye, 1e-5f, 1e-7f, kept, counts);
      std::size_t culled = 0;
      for (const ClusterRange& range : leaf_clusters(tree)) {
        const bool back = turns_back(range.cluster, eye, 1e-5f + 1e-7f * range.cluster.sharpness);
        for (std::uint32_t place = range.begin; place < range.end; ++place) {
          const bool gone = ((kept[place / 64] >> (place % 64)) & 1) == 0;
          culled += gone ? 1 : 0;
          EXPECT_TRUE(gone || !back) << leaf << " " << place;
          const glm::uvec3& t = mesh.triangles[tree.order[place]];
          const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
          EXPECT_TRUE(!gone || glm::dot(glm::cross(b - a, c - a), glm::dvec3(glm::vec3(eye)) - a) < 0.0);
        }
      }
      EXPECT_EQ(counts.culled, culled);
      if (mesh.triangles.size() % 64 != 0) {
        EXPECT_EQ(kept.back() >> (mesh.triangles.size() % 64), 0u);
      }
    }
  }
}

/// One sliver would make its whole cluster uncertain; slivers share clusters of their own.
TEST(ClusterTree, ThinTrianglesAreSetApart) {
  Mesh ball = make_ball(100, 60);
  const std::size_t whole = ball.triangles.size();
  for (std::uint32_t i = 0; i < 100; ++i) {  // slivers all over the ball
    const glm::vec3 p = ball.positions[53 * i], q = ball.positions[53 * i + 1];
    const auto first = static_cast<std::uint32_t>(ball.positions.size());
    ball.positions.insert(ball.positions.end(), {p, q, 0.5f * (p + q) + glm::vec3(1e-6f)});
    ball.triangles.push_back({first, first + 1, first + 2});
  }
  const ClusterTree tree = build_cluster_tree(ball.positions, ball.triangles, {});
  std::size_t sharp = 0;
  for (const ClusterRange& range : leaf_clusters(tree))
    if (range.cluster.sharpness > 1e4f) sharp += range.end - range.begin;
  EXPECT_GE(sharp, 100u);
  EXPECT_LE(sharp, whole / 8);
}

TEST(ClusterTree, EveryTargetGivesTheReferencesAnswer) {
  Random random(5);
  Mesh mesh = make_ball(37, 21);
  for (glm::vec3& p : mesh.positions) p *= static_cast<float>(random.range(0.9, 1.1));
  mesh.triangles.push_back({0, 0, 1});
  for (const int leaf : {2, 16, 64}) {
    ClusterTreeConfig config;
    config.leaf = leaf;
    const ClusterTree tree = build_cluster_tree(mesh.positions, mesh.triangles, {0.1f, 0, 0}, config);
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      hwy::SetSupportedTargetsForTest(target);
      hwy::GetChosenTarget().DeInit();
      for (int i = 0; i < 60; ++i) {
        const glm::vec4 eye(glm::vec3(random.range(0.5, 9) * random.direction()), i % 3 == 0 ? 0.0f : 1.0f);
        std::vector<std::uint64_t> a((mesh.triangles.size() + 63) / 64), b(a.size());
        ClusterCounts ca, cb;
        front_clusters(tree, eye, 1e-5f, 1e-7f, a, ca);
        front_clusters_scalar(tree, eye, 1e-5f, 1e-7f, b, cb);
        EXPECT_EQ(a, b) << hwy::TargetName(target);
        EXPECT_EQ(ca.tested, cb.tested);
        EXPECT_LE(ca.tested, tree.clusters);
      }
    }
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
}

/// 19.11: the walk stops where a cluster is wholly back or front.
TEST(ClusterTree, StopsEarly) {
  const Mesh ball = make_ball(200, 120);
  const ClusterTree tree = build_cluster_tree(ball.positions, ball.triangles, {});
  std::vector<std::uint64_t> kept((ball.triangles.size() + 63) / 64);
  ClusterCounts counts;
  front_clusters(tree, {0, 0, 50, 1}, 1e-5f, 0.0f, kept, counts);
  EXPECT_LT(counts.tested, tree.clusters * 9 / 10);
}

/// The cost model merges more where a test is dear.
TEST(ClusterTree, DearTestsMakeFewerClusters) {
  const Mesh ball = make_ball(80, 50);
  const auto leaves = [&](double cost) {
    ClusterTreeConfig config;
    config.leaf = 4;
    config.cost_test = cost;
    return build_cluster_tree(ball.positions, ball.triangles, {}, config).leaves;
  };
  EXPECT_GT(leaves(0.01), leaves(4));
  EXPECT_GT(leaves(4), leaves(50));
}

TEST(ClusterTree, DegenerateInput) {
  EXPECT_TRUE(build_cluster_tree({}, {}, {}).levels.empty());
  const std::vector<glm::vec3> points(4, glm::vec3(1, 2, 3));
  const std::vector<glm::uvec3> flat(500, glm::uvec3(0, 1, 2));
  const ClusterTree tree = build_cluster_tree(points, flat, {});
  std::vector<std::uint64_t> kept(8);
  ClusterCounts counts;
  front_clusters(tree, {9, 9, 9, 1}, 1e-5f, 0.0f, kept, counts);  // no area: all kept
  for (std::size_t i = 0; i < 500; ++i) EXPECT_TRUE((kept[i / 64] >> (i % 64)) & 1);
  // Normals and places in a geometric row: a mean would part off one by one.
  std::vector<glm::vec3> row;
  std::vector<glm::uvec3> triangles;
  for (std::uint32_t i = 0; i < 3000; ++i) {
    const float x = std::pow(1.02f, -static_cast<float>(i));
    row.insert(row.end(), {{x, 0, 0}, {x * 1.001f, 0, 0}, {x, x * 0.001f, 0}});
    triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  ClusterTreeConfig config;
  config.leaf = 1;
  EXPECT_EQ(build_cluster_tree(row, triangles, {}, config).order.size(), 3000u);
}

}  // namespace
}  // namespace sightline
