// Triangulated polygons cover the polygon: right number, right area, no triangle the wrong way round.
#include "sightline/geometry/triangulate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace sightline {
namespace {

double signed_area(const std::vector<glm::vec3>& p) {
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < p.size(); ++i) sum += glm::cross(glm::dvec3(p[i]), glm::dvec3(p[(i + 1) % p.size()]));
  return 0.5 * sum.z;
}

/// Expects that the triangles of a polygon in z = const cover it exactly once: their areas have the sign of the
/// polygon's and add up to it.
void expect_covers(const std::vector<glm::vec3>& polygon) {
  const std::vector<glm::uvec3> triangles = triangulate_polygon(polygon);
  ASSERT_EQ(triangles.size(), polygon.size() - 2);
  const double whole = signed_area(polygon);
  double sum = 0.0;
  std::set<std::uint32_t> used;
  for (const glm::uvec3& t : triangles) {
    const double part = signed_area({polygon[t.x], polygon[t.y], polygon[t.z]});
    EXPECT_GE(part * whole, 0.0) << t.x << " " << t.y << " " << t.z;
    sum += part;
    used.insert({t.x, t.y, t.z});
  }
  EXPECT_NEAR(sum, whole, 1e-6 * std::abs(whole));
  EXPECT_EQ(used.size(), polygon.size());
}

void expect_covers_both_ways(std::vector<glm::vec3> polygon) {
  expect_covers(polygon);
  std::reverse(polygon.begin(), polygon.end());
  expect_covers(polygon);
}

TEST(Triangulate, Triangle) { expect_covers_both_ways({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}); }
TEST(Triangulate, Square) { expect_covers_both_ways({{0, 0, 5}, {1, 0, 5}, {1, 1, 5}, {0, 1, 5}}); }
TEST(Triangulate, ConcaveQuad) { expect_covers_both_ways({{0, 0, 0}, {4, 0, 0}, {1, 1, 0}, {0, 4, 0}}); }

TEST(Triangulate, ConcaveQuadFromEveryCorner) {
  const std::vector<glm::vec3> dart = {{0, 0, 0}, {4, 0, 0}, {1, 1, 0}, {0, 4, 0}};
  for (std::size_t start = 0; start < 4; ++start) {
    std::vector<glm::vec3> turned = dart;
    std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(start), turned.end());
    expect_covers(turned);
  }
}

TEST(Triangulate, CollinearCornersAreKept) {
  expect_covers_both_ways({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}});
}

TEST(Triangulate, Comb) {
  std::vector<glm::vec3> comb;
  for (int tooth = 0; tooth < 40; ++tooth) {
    comb.emplace_back(2 * tooth, 10, 0);
    comb.emplace_back(2 * tooth + 1, 1, 0);
  }
  comb.emplace_back(80, 10, 0);
  comb.emplace_back(80, 0, 0);
  comb.emplace_back(0, 0, 0);
  expect_covers_both_ways(comb);
}

TEST(Triangulate, HoleThroughAKeyhole) {
  expect_covers_both_ways(
      {{0, 0, 0}, {6, 0, 0}, {6, 6, 0}, {0, 6, 0}, {0, 0, 0}, {2, 2, 0}, {2, 4, 0}, {4, 4, 0}, {4, 2, 0}, {2, 2, 0}});
}

TEST(Triangulate, StarOfThousandCorners) {
  std::vector<glm::vec3> star;
  for (int i = 0; i < 1000; ++i) {
    const double angle = 2.0 * 3.14159265358979 * i / 1000.0, radius = i % 2 == 0 ? 10.0 : 6.0;
    star.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0);
  }
  expect_covers_both_ways(star);
}

TEST(Triangulate, LargeConvexIsAFanAndLargeConcaveIsRefused) {
  std::vector<glm::vec3> circle;
  for (int i = 0; i < 3000; ++i) {
    const double angle = 2.0 * 3.14159265358979 * i / 3000.0;
    circle.emplace_back(1000.0 * std::cos(angle), 1000.0 * std::sin(angle), 0.0);
  }
  EXPECT_EQ(triangulate_polygon(circle).size(), 2998u);
  circle[7] *= 0.1f;
  EXPECT_TRUE(triangulate_polygon(circle).empty());
}

TEST(Triangulate, AnyPlaneAndSelfCrossingStillGiveAllTriangles) {
  for (const glm::vec3 axis : {glm::vec3(1, 2, 3), glm::vec3(-3, 0.1, 0), glm::vec3(0, -1, 0)}) {
    const glm::vec3 u = glm::normalize(glm::cross(axis, glm::vec3(0.3, 0.5, -0.7))),
                    v = glm::cross(glm::normalize(axis), u);
    std::vector<glm::vec3> dart;
    for (const glm::vec2 p : {glm::vec2(0, 0), glm::vec2(4, 0), glm::vec2(1, 1), glm::vec2(0, 4)})
      dart.push_back(u * p.x + v * p.y);
    for (const glm::uvec3& t : triangulate_polygon(dart)) {
      const glm::vec3 normal = glm::cross(dart[t.y] - dart[t.x], dart[t.z] - dart[t.x]);
      EXPECT_GT(glm::dot(normal, axis), 0.0f);
    }
  }
  EXPECT_EQ(triangulate_polygon(std::vector<glm::vec3>{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}).size(), 2u);
  EXPECT_EQ(triangulate_polygon(std::vector<glm::vec3>(5, glm::vec3(1))).size(), 3u);
  EXPECT_TRUE(triangulate_polygon(std::vector<glm::vec3>(2)).empty());
}

}  // namespace
}  // namespace sightline
