// Boolean operations: volumes against closed forms and inclusion-exclusion, membership against rays of the operands.
#include "sightline/index/bsp_boolean.hpp"

#include <gtest/gtest.h>

#include <glm/gtc/quaternion.hpp>

#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/generate/shapes.hpp"

namespace sightline {
namespace {

PolygonSet solid(const Mesh& mesh, const glm::dquat& turn = {1, 0, 0, 0}, const glm::dvec3& place = {0, 0, 0},
                 double scale = 1.0) {
  PolygonSet set;
  for (const glm::uvec3& t : mesh.triangles) {
    glm::dvec3 corners[3];
    for (int k = 0; k < 3; ++k) corners[k] = turn * (scale * glm::dvec3(mesh.positions[t[k]])) + place;
    set.add(corners);
  }
  return set;
}

PolygonSet box(const glm::vec3& lo, const glm::vec3& hi) { return solid(make_box(lo, hi)); }

double volume(const PolygonSet& a, const PolygonSet& b, BooleanOp op) {
  return enclosed_volume(boolean_of(a, b, op).polygons);
}

/// Independent of any tree: how often a ray in an odd direction crosses the surface.
bool inside_by_parity(const PolygonSet& set, const glm::dvec3& p) {
  const glm::dvec3 direction(0.8312, 0.4271, 0.3571);
  int crossings = 0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    const auto polygon = set[i];
    for (std::size_t k = 2; k < polygon.size(); ++k) {
      const glm::dvec3 e1 = polygon[k - 1] - polygon[0], e2 = polygon[k] - polygon[0], s = p - polygon[0];
      const glm::dvec3 q = glm::cross(direction, e2), r = glm::cross(s, e1);
      const double det = glm::dot(e1, q);
      if (det == 0.0) continue;
      const double u = glm::dot(s, q) / det, v = glm::dot(direction, r) / det, t = glm::dot(e2, r) / det;
      if (u >= 0 && v >= 0 && u + v <= 1 && t > 0) ++crossings;
    }
  }
  return crossings % 2 == 1;
}

TEST(BspBoolean, BoxesHaveTheVolumesOfArithmetic) {
  const PolygonSet a = box({0, 0, 0}, {2, 2, 2}), b = box({1, 1, 1}, {3, 4, 5});
  EXPECT_NEAR(volume(a, b, BooleanOp::unite), 8 + 24 - 1, 1e-12);
  EXPECT_NEAR(volume(a, b, BooleanOp::intersect), 1, 1e-12);
  EXPECT_NEAR(volume(a, b, BooleanOp::subtract), 7, 1e-12);
  EXPECT_NEAR(volume(b, a, BooleanOp::subtract), 23, 1e-12);
}

TEST(BspBoolean, NestedApartAndEmpty) {
  const PolygonSet big = box({0, 0, 0}, {4, 4, 4}), small = box({1, 1, 1}, {2, 2, 2}),
                   away = box({9, 9, 9}, {10, 10, 10});
  EXPECT_NEAR(volume(big, small, BooleanOp::unite), 64, 1e-12);
  EXPECT_NEAR(volume(big, small, BooleanOp::intersect), 1, 1e-12);
  EXPECT_NEAR(volume(big, small, BooleanOp::subtract), 63, 1e-12);  // a hollow
  EXPECT_NEAR(volume(small, big, BooleanOp::subtract), 0, 1e-12);
  EXPECT_NEAR(volume(big, away, BooleanOp::unite), 65, 1e-12);
  EXPECT_EQ(boolean_of(big, away, BooleanOp::intersect).polygons.size(), 0u);
  EXPECT_NEAR(volume(big, {}, BooleanOp::unite), 64, 1e-12);
  EXPECT_NEAR(volume({}, big, BooleanOp::unite), 64, 1e-12);
  EXPECT_NEAR(volume(big, {}, BooleanOp::subtract), 64, 1e-12);
  EXPECT_EQ(boolean_of({}, big, BooleanOp::intersect).polygons.size(), 0u);
}

TEST(BspBoolean, FacesThatCoincideCountOnce) {
  const PolygonSet a = box({0, 0, 0}, {2, 2, 2});
  EXPECT_NEAR(volume(a, a, BooleanOp::unite), 8, 1e-12);
  EXPECT_NEAR(volume(a, a, BooleanOp::intersect), 8, 1e-12);
  EXPECT_EQ(boolean_of(a, a, BooleanOp::subtract).polygons.size(), 0u);
  const PolygonSet beside = box({2, 0, 0}, {3, 2, 2});  // touches: the wall between them goes
  const BooleanResult both = boolean_of(a, beside, BooleanOp::unite);
  EXPECT_NEAR(enclosed_volume(both.polygons), 12, 1e-12);
  for (std::size_t i = 0; i < both.polygons.size(); ++i) {
    bool wall = true;
    for (const glm::dvec3& p : both.polygons[i]) wall = wall && p.x == 2;
    EXPECT_FALSE(wall);
  }
  EXPECT_EQ(enclosed_volume(boolean_of(a, beside, BooleanOp::intersect).polygons), 0.0);
  EXPECT_NEAR(volume(a, beside, BooleanOp::subtract), 8, 1e-12);
  const PolygonSet flush = box({0, 0, 1}, {1, 1, 2});  // shares three faces in part
  EXPECT_NEAR(volume(a, flush, BooleanOp::subtract), 7, 1e-12);
  EXPECT_NEAR(volume(a, flush, BooleanOp::unite), 8, 1e-12);
  EXPECT_NEAR(volume(a, flush, BooleanOp::intersect), 1, 1e-12);
}

TEST(BspBoolean, RoundAndTurnedSolidsKeepInclusionAndExclusion) {
  const glm::dquat turn = glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 3, 2)));
  const PolygonSet ball = solid(make_ball(24, 12)), post = solid(make_cylinder(17), turn, {0.1, -0.7, 0.2}, 0.9);
  const double a = enclosed_volume(ball), b = enclosed_volume(post);
  for (const BspSplitter splitter : {BspSplitter::random, BspSplitter::mixed, BspSplitter::pca}) {
    BspConfig config;
    config.splitter = splitter;
    const auto both = [&](BooleanOp op) { return boolean_of(ball, post, op, config); };
    const BooleanResult united = both(BooleanOp::unite), common = both(BooleanOp::intersect),
                        rest = both(BooleanOp::subtract);
    const double common_volume = enclosed_volume(common.polygons);
    EXPECT_GT(common_volume, 0.1);
    EXPECT_NEAR(enclosed_volume(united.polygons), a + b - common_volume, 1e-9);
    EXPECT_NEAR(enclosed_volume(rest.polygons), a - common_volume, 1e-9);
    // Monte Carlo, without the trees: the share of points in both operands.
    Random random(7);
    int in_both = 0;
    constexpr int n = 20000;
    const Bsp tree_of_rest = build_bsp(rest.polygons, config), tree_of_union = build_bsp(united.polygons, config);
    for (int i = 0; i < n; ++i) {
      const glm::dvec3 p(random.range(-1, 1), random.range(-1, 1), random.range(-1, 1));
      const bool in_a = inside_by_parity(ball, p), in_b = inside_by_parity(post, p);
      in_both += in_a && in_b ? 1 : 0;
      if (i % 10 != 0) continue;
      ASSERT_EQ(is_inside(tree_of_rest, p), in_a && !in_b);  // the result is a solid that has a tree of its own
      ASSERT_EQ(is_inside(tree_of_union, p), in_a || in_b);
    }
    EXPECT_NEAR(8.0 * in_both / n, common_volume, 0.08);
  }
}

TEST(BspBoolean, ResultsAreOperandsAgain) {
  PolygonSet cheese = box({0, 0, 0}, {4, 4, 4});
  double expected = 64;
  for (int i = 0; i < 3; ++i) {  // three square tunnels that do not meet
    const auto o = static_cast<float>(i) * 1.25f + 0.25f;
    cheese = boolean_of(cheese, box({o, 1, -1}, {o + 1, 2, 5}), BooleanOp::subtract).polygons;
    expected -= 4;
    EXPECT_NEAR(enclosed_volume(cheese), expected, 1e-10);
  }
}

TEST(BspBoolean, PiecesKnowTheirSource) {
  const PolygonSet a = box({0, 0, 0}, {2, 2, 2}), b = box({1, 1, 1}, {3, 3, 3});
  const BooleanResult result = boolean_of(a, b, BooleanOp::subtract);
  ASSERT_EQ(result.source.size(), result.polygons.size());
  for (std::size_t i = 0; i < result.polygons.size(); ++i) {
    const PolygonSet& from = result.from_second[i] != 0 ? b : a;
    const double along = glm::dot(plane_of(from[result.source[i]]).normal, plane_of(result.polygons[i]).normal);
    EXPECT_NEAR(along, result.from_second[i] != 0 ? -1.0 : 1.0, 1e-12);  // of b they are turned around
  }
}

}  // namespace
}  // namespace sightline
