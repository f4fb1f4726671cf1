// What the structures that rays are traced through may hold: cells, nodes and items for each triangle, and where
// splitting ends. That they find the right hits is in trace_test.cpp.
#include <gtest/gtest.h>

#include <bit>

#include "sightline/index/axis_tree.hpp"
#include "sightline/index/bvh8.hpp"
#include "sightline/index/grid.hpp"
#include "sightline/index/kdtree.hpp"
#include "sightline/index/plane_tree.hpp"
#include "sightline/scene/generate/generate.hpp"
#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/scene_soup.hpp"

namespace sightline {
namespace {

void add(TriangleSoup& soup, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  soup.corners.insert(soup.corners.end(), {a, b, c});
}

/// Long slivers through all of a cube: wherever it is cut, many of them lie on both sides.
TriangleSoup slivers(int n) {
  Random random(7);
  TriangleSoup soup;
  const auto anywhere = [&] { return glm::vec3(random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)); };
  for (int i = 0; i < n; ++i) {
    const glm::vec3 a = anywhere(), b = anywhere();
    add(soup, a, b, b + 0.01f * glm::vec3(random.direction()));
  }
  return soup;
}

TEST(KdTree, TheMedianStopsWhereSplitsPartLittle) {
  const TriangleSoup soup = slivers(2000);
  const KdTree tree = build_kdtree(soup, {.split = KdSplit::median});
  EXPECT_GT(tree.nodes.size(), soup.size() / 8) << "it must not stop at once";
  EXPECT_LT(tree.items.size(), 50 * soup.size());
}

TEST(PlaneTree, PartsOfTrianglesDecideWhereTheyAreKept) {
  const TriangleSoup soup = slivers(2000);
  const PlaneTree tree = build_plane_tree(soup);
  std::uint32_t fullest = 0;
  for (const PlaneNode& node : tree.nodes) fullest = std::max(fullest, node.count);
  EXPECT_LT(fullest, soup.size() / 2);
  EXPECT_LE(tree.items.size(), 5 * soup.size());
}

TEST(Grid, HoldsAFewCellsForEachTriangleAndNeverMoreThanAsked) {  // 14.02, 14.03
  const TriangleSoup soup = soup_of(generate_scene("city", {.objects = 60}));
  const auto cells = [](const Grid& grid) {
    return static_cast<double>(grid.resolution.x) * grid.resolution.y * grid.resolution.z;
  };
  const double n = static_cast<double>(soup.size());
  const Grid grid = build_grid(soup);
  EXPECT_GT(cells(grid), 0.5 * n);
  EXPECT_LT(cells(grid), 8.0 * n);
  const Grid finer = build_grid(soup, {.cells_per_triangle = 16.0});
  EXPECT_GT(cells(finer), 4.0 * cells(grid));
  EXPECT_GT(finer.bytes(), grid.bytes());
  EXPECT_LE(cells(build_grid(soup, {.cells_per_triangle = 1e6, .most_cells = 1000})), 1000.0);
}

TEST(AxisTree, SplittingEndsWhereOneReferencePerCellWouldNot) {
  TriangleSoup fan;  // 50 triangles around one point: no cell at it ever holds one (E26)
  Random random(3);
  for (int i = 0; i < 50; ++i) add(fan, {0, 0, 0}, glm::vec3(random.direction()), glm::vec3(random.direction()));
  const AxisTree tree = build_axis_tree(fan, {.leaf_size = 1, .max_depth = 12});
  EXPECT_LT(tree.nodes.size(), 100000u);
  std::uint32_t fullest = 0;
  int deepest = 0;
  for_each_cell(tree, [&](const Aabb&, int depth, const AxisNode& node) {
    if (node.axes == 0) fullest = std::max<std::uint32_t>(fullest, node.count);
    deepest = std::max(deepest, depth);
  });
  EXPECT_GT(fullest, 1u);
  EXPECT_LE(deepest, 12);
}

TEST(AxisTree, NumberOfChildrenFollowsTheAxes) {
  const TriangleSoup soup = soup_of(generate_scene("city", {.objects = 20}));
  for (const std::uint32_t axes : {1u, 5u, 7u}) {
    const AxisTree tree = build_axis_tree(soup, {.axes = axes, .cube = false, .leaf_size = 4});
    std::size_t inner = 0, children = 0;
    for (const AxisNode& node : tree.nodes) {
      if (node.axes == 0) continue;
      ++inner;
      children += std::size_t{1} << std::popcount(std::uint32_t{node.axes});
    }
    EXPECT_EQ(children + 1, tree.nodes.size());
    EXPECT_GT(inner, 3u);
    if (axes == 5u) {
      EXPECT_EQ(children, 4 * inner) << "a quadtree";
    }
  }
}

TEST(Bvh8, HoldsAHundredThousandTrianglesInAFewMegabytes) {
  GenerateConfig config;
  config.objects = 400;
  config.triangles = 100000;
  const TriangleSoup soup = soup_of(generate_scene("city", config));
  const Bvh8 tree = build_bvh8(soup);
  EXPECT_EQ(tree.triangle_count, soup.size());
  EXPECT_LE(tree.bytes(), 48 * soup.size());
}

}  // namespace
}  // namespace sightline
