// Rays against spheres, planes, polygons, triangles and boxes: the formulas, and every case in which they have none.
#include <gtest/gtest.h>

#include <array>

#include "properties.hpp"
#include "sightline/geometry/ray_box.hpp"
#include "sightline/geometry/ray_plane.hpp"
#include "sightline/geometry/ray_sphere.hpp"
#include "sightline/geometry/ray_triangle.hpp"
#include "sightline/geometry/triangle_overlap.hpp"
#include "sightline/scene/generate/random.hpp"

namespace sightline {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();

/// What is no ray.
std::vector<Ray> broken_rays() {
  return {{{nan, 0, 0}, 0, {0, 0, -1}, inf}, {{0, 0, 5}, 0, {0, nan, -1}, inf}, {{0, 0, 5}, 0, {0, 0, 0}, inf},
          {{0, inf, 5}, 0, {0, 0, -1}, inf}, {{0, 0, 5}, 0, {0, 0, -inf}, inf}, {{0, 0, 5}, nan, {0, 0, -1}, inf},
          {{0, 0, 5}, 0, {0, 0, -1}, nan},   {{0, 0, 5}, 2, {0, 0, -1}, 1},     {{0, 0, 5}, 0, {0, 0, -1e-30f}, inf}};
}

TEST(RaySphere, TwoOneOrNoCrossing) {
  const Ray ray{{0, 0, 5}, 0, {0, 0, -1}, inf};
  const Crossings two = hit_sphere(ray, {0, 0, 0}, 2);
  ASSERT_EQ(two.count, 2);
  EXPECT_DOUBLE_EQ(two.t[0], 3);
  EXPECT_DOUBLE_EQ(two.t[1], 7);
  EXPECT_EQ(hit_sphere({{0, 0, 0.5f}, 0, {0, 0, -1}, inf}, {0, 0, 0}, 2).count, 1) << "from inside";
  EXPECT_EQ(hit_sphere({{0, 0, -5}, 0, {0, 0, -1}, inf}, {0, 0, 0}, 2).count, 0) << "behind the eye";
  const Crossings grazing = hit_sphere({{2, 0, 5}, 0, {0, 0, -1}, inf}, {0, 0, 0}, 2);
  ASSERT_EQ(grazing.count, 1);
  EXPECT_DOUBLE_EQ(grazing.t[0], 5);
  EXPECT_EQ(hit_sphere({{2.001f, 0, 5}, 0, {0, 0, -1}, inf}, {0, 0, 0}, 2).count, 0);
  EXPECT_EQ(hit_sphere({{0, 0, 5}, 0, {0, 0, -2}, inf}, {0, 0, 0}, 2).t[0], 1.5) << "t counts in lengths of direction";
  EXPECT_EQ(hit_sphere(ray, {0, 0, 0}, 0).count, 1) << "a point";
  EXPECT_EQ(hit_sphere(ray, {0, 0, 0}, -1).count, 0);
  EXPECT_EQ(hit_sphere(ray, {0, 0, 0}, nan).count, 0);
  for (const Ray& broken : broken_rays()) EXPECT_EQ(hit_sphere(broken, {0, 0, 0}, 2).count, 0);
}

TEST(RaySphere, KeepsItsDigitsFarAway) {
  // b^2 - 4ac of the slide loses the sphere here: 1e6 away, radius 1.
  const Crossings far = hit_sphere({{0, 0.5f, 1e6f}, 0, {0, 0, -1}, inf}, {0, 0, 0}, 1);
  ASSERT_EQ(far.count, 2);
  EXPECT_NEAR(far.t[0], 1e6 - std::sqrt(0.75), 1e-9);
  EXPECT_NEAR(far.t[1], 1e6 + std::sqrt(0.75), 1e-9);
}

TEST(RayPlane, ParallelBehindAndBroken) {
  const Ray down{{1, 3, 1}, 0, {0, -2, 0}, inf};
  EXPECT_DOUBLE_EQ(hit_plane(down, {0, 1, 0}, {0, 5, 0}).value(), 1);
  EXPECT_FALSE(hit_plane(down, {0, 4, 0}, {0, 1, 0})) << "behind";
  EXPECT_FALSE(hit_plane(down, {0, 1, 0}, {1, 0, 0})) << "parallel";
  EXPECT_FALSE(hit_plane(down, {1, 1, 0}, {1, 0, 0})) << "within the plane";
  EXPECT_FALSE(hit_plane(down, {0, 1, 0}, {0, 0, 0}));
  EXPECT_FALSE(hit_plane(down, {0, 1, 0}, {nan, 0, 0}));
  for (const Ray& broken : broken_rays()) EXPECT_FALSE(hit_plane(broken, {0, 0, 0}, {0, 0, 1}));
}

TEST(RayPolygon, ConcaveEitherWayRoundAndDegenerate) {
  std::vector<glm::vec3> arrow{{-2, -2, 0}, {0, -1, 0}, {2, -2, 0}, {0, 2, 0}};
  const auto at = [&](float x, float y) { return hit_polygon({{x, y, 5}, 0, {0, 0, -1}, inf}, arrow); };
  for (int way = 0; way < 2; ++way) {
    EXPECT_TRUE(at(0, 0));
    EXPECT_FALSE(at(0, -1.5f)) << "the notch";
    EXPECT_TRUE(at(1, -1.5f)) << "on an edge";
    EXPECT_TRUE(at(0, 2)) << "a corner";
    EXPECT_FALSE(at(3, 0));
    std::reverse(arrow.begin(), arrow.end());
  }
  EXPECT_FALSE(hit_polygon({{0, 0, 5}, 0, {0, 0, -1}, inf}, std::vector<glm::vec3>{{0, 0, 0}, {1, 1, 0}}));
  EXPECT_FALSE(hit_polygon({{0, 0, 5}, 0, {0, 0, -1}, inf}, std::vector<glm::vec3>{{-1, 0, 0}, {1, 0, 0}, {0, 0, 0}}));
}

TEST(RayTriangle, ThreeTestsAgreeAwayFromEdges) {
  Random random(5);
  const auto point = [&] { return glm::vec3(random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)); };
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const glm::vec3 a = point(), b = point(), c = point();
    const Ray ray{3.0f * point(), 0, point(), inf};
    const auto areas = hit_triangle_areas(ray, a, b, c), barycentric = hit_triangle_barycentric(ray, a, b, c),
               watertight = hit_triangle_watertight(ray, a, b, c);
    const TriangleHit* any = areas ? &*areas : barycentric ? &*barycentric : watertight ? &*watertight : nullptr;
    if (any == nullptr) continue;
    const double least = std::min({any->alpha, any->beta, any->gamma});
    if (least < 1e-4) continue;  // on an edge
    ASSERT_TRUE(areas && barycentric && watertight) << i;
    ++hits;
    EXPECT_NEAR(areas->alpha, barycentric->alpha, 1e-6);
    EXPECT_NEAR(areas->gamma, barycentric->gamma, 1e-6);
    EXPECT_NEAR(barycentric->t, watertight->t, 1e-3 * (1 + barycentric->t));
    EXPECT_NEAR(barycentric->alpha + barycentric->beta + barycentric->gamma, 1.0, 1e-12);
    const glm::dvec3 p =
        barycentric->alpha * glm::dvec3(a) + barycentric->beta * glm::dvec3(b) + barycentric->gamma * glm::dvec3(c);
    EXPECT_LT(glm::length(p - point_at(ray, barycentric->t)), 1e-9 * (1 + barycentric->t));
  }
  EXPECT_GT(hits, 50);
}

TEST(RayTriangle, CornersOfTheBarycentricSpace) {
  const glm::vec3 a(0, 0, 0), b(4, 0, 0), c(0, 4, 0);
  const auto at = [&](float x, float y) { return hit_triangle_barycentric({{x, y, 1}, 0, {0, 0, -1}, inf}, a, b, c); };
  EXPECT_EQ(at(0, 0)->alpha, 1);
  EXPECT_EQ(at(4, 0)->beta, 1);
  EXPECT_EQ(at(0, 4)->gamma, 1);
  EXPECT_EQ(at(2, 2)->alpha, 0) << "edge b - c";
  EXPECT_FALSE(at(-0.001f, 1));
  EXPECT_FALSE(at(2.001f, 2));
}

TEST(RayTriangle, DegenerateOnesAreNeverHit) {
  const Ray ray{{0, 0, 5}, 0, {0, 0, -1}, inf};
  const glm::vec3 o(0), x(1, 0, 0), y(2, 0, 0), up(0, 0, 1);
  EXPECT_FALSE(hit_triangle_areas(ray, o, o, o) || hit_triangle_areas(ray, o, x, y));
  EXPECT_FALSE(hit_triangle_barycentric(ray, o, o, o) || hit_triangle_barycentric(ray, o, x, y));
  EXPECT_FALSE(hit_triangle_watertight(ray, o, o, o) || hit_triangle_watertight(ray, o, x, y));
  EXPECT_FALSE(hit_triangle_watertight(ray, -x, x, up)) << "edge-on";
  EXPECT_FALSE(hit_triangle_barycentric(ray, -x, x, up)) << "edge-on";
  for (const Ray& broken : broken_rays()) {
    EXPECT_FALSE(hit_triangle_areas(broken, {-9, -9, 0}, {9, -9, 0}, {0, 9, 0}));
    EXPECT_FALSE(hit_triangle_barycentric(broken, {-9, -9, 0}, {9, -9, 0}, {0, 9, 0}));
    EXPECT_FALSE(hit_triangle_watertight(broken, {-9, -9, 0}, {9, -9, 0}, {0, 9, 0}));
  }
}

/// Rays at a shared edge of two triangles: the watertight test misses none, the textbook one does.
TEST(RayTriangle, NoRayPassesBetweenNeighbours) {
  Random random(6);
  int barycentric_misses = 0, watertight_misses = 0;
  for (int i = 0; i < 200000; ++i) {
    const auto point = [&] {
      return glm::vec3(random.range(-1, 1), random.range(-1, 1), random.range(-0.2, 0.2)) + glm::vec3(100, 0, 0);
    };
    const glm::vec3 a = point(), b = point();
    const glm::vec3 target = glm::mix(a, b, static_cast<float>(random.range(0.1, 0.9)));
    const glm::vec3 origin = target + 7.0f * glm::vec3(random.range(-0.3, 0.3), random.range(-0.3, 0.3), 1);
    // To both sides of the edge as the ray sees it.
    const glm::vec3 across = glm::normalize(glm::cross(b - a, target - origin));
    const glm::vec3 left = target + static_cast<float>(random.range(0.1, 1)) * across + 0.3f * (b - a);
    const glm::vec3 right = target - static_cast<float>(random.range(0.1, 1)) * across;
    const Ray ray{origin, 0, target - origin, inf};
    watertight_misses += !hit_triangle_watertight(ray, a, b, left) && !hit_triangle_watertight(ray, b, a, right);
    barycentric_misses += !hit_triangle_barycentric(ray, a, b, left) && !hit_triangle_barycentric(ray, b, a, right);
  }
  EXPECT_EQ(watertight_misses, 0);
  RecordProperty("barycentric_misses", barycentric_misses);
}

TEST(RayBox, InsideGrazingParallelAndEmpty) {
  const Aabb box{{-1, -1, -1}, {1, 1, 1}};
  const auto through = hit_box({{0, 0, 5}, 0, {0, 0, -1}, inf}, box);
  ASSERT_TRUE(through);
  EXPECT_EQ(through->enter, 4);
  EXPECT_EQ(through->leave, 6);
  EXPECT_EQ(hit_box({{0, 0, 0}, 0, {0, 0, -1}, inf}, box)->enter, 0);
  EXPECT_TRUE(hit_box({{1, 0, 5}, 0, {0, 0, -1}, inf}, box)) << "in a face";
  EXPECT_FALSE(hit_box({{1.0001f, 0, 5}, 0, {0, 0, -1}, inf}, box));
  EXPECT_TRUE(hit_box({{2, 0, 0}, 0, {-1, 1, 0}, inf}, box)) << "through an edge";
  EXPECT_FALSE(hit_box({{0, 0, 5}, 0, {0, 0, 1}, inf}, box)) << "behind";
  EXPECT_FALSE(hit_box({{0, 0, 5}, 0, {0, 0, -1}, 3}, box)) << "too short";
  EXPECT_FALSE(hit_box({{0, 0, 5}, 0, {0, 0, -1}, inf}, Aabb{}));
  for (const Ray& broken : broken_rays()) EXPECT_FALSE(hit_box(broken, box));
}

TEST(TriangleOverlap, BoxAgreesWithSamples) {
  Random random(9);
  const auto point = [&] { return glm::vec3(random.range(-2, 2), random.range(-2, 2), random.range(-2, 2)); };
  const Aabb box{{-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}};
  int touching = 0, apart = 0;
  for (int i = 0; i < 20000; ++i) {
    const glm::vec3 t[3] = {point(), point(), point()};
    const bool touches = triangle_touches_box(t, box);
    bool sampled = false;
    for (int s = 0; s < 60; ++s) {
      float u = static_cast<float>(random.uniform()), v = static_cast<float>(random.uniform());
      if (u + v > 1) u = 1 - u, v = 1 - v;
      sampled |= box.contains(t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]));
    }
    if (sampled) {
      EXPECT_TRUE(touches);
    }
    touching += touches;
    apart += !touches;
  }
  EXPECT_GT(touching, 1000);
  EXPECT_GT(apart, 1000);
  const glm::vec3 diagonal[3] = {{2, 0, 0}, {0, 2, 0}, {2, 2, 0}};
  EXPECT_FALSE(triangle_touches_box(diagonal, box)) << "boxes overlap, the triangle passes the corner";
  EXPECT_TRUE(triangle_touches_box(diagonal, box, 0.51));
}

}  // namespace
}  // namespace sightline
