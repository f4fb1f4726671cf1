// Spheres, oriented boxes, k-DOPs and hulls: they hold their points, are as small as they claim, survive flat and
// degenerate sets, and their frustum tests never lose what is inside.
#include <gtest/gtest.h>

#include "sightline/geometry/hull.hpp"
#include "sightline/geometry/kdop.hpp"
#include "sightline/geometry/obb.hpp"
#include "sightline/geometry/sphere.hpp"
#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/view.hpp"

namespace sightline {
namespace {

/// Clouds of every dimension, on grids (many equal distances), in rotated boxes, on spheres, and few points.
std::vector<std::vector<glm::vec3>> clouds() {
  Random random(3);
  std::vector<std::vector<glm::vec3>> all{
      {}, {glm::vec3(1, 2, 3)}, {glm::vec3(1, 2, 3), glm::vec3(1, 2, 3)}, {glm::vec3(0), glm::vec3(1, 1, 0)}};
  for (int kind = 0; kind < 60; ++kind) {
    std::vector<glm::vec3>& points = all.emplace_back();
    const glm::dmat3 turn = glm::mat3_cast(glm::angleAxis(random.range(0, 6), random.direction()));
    const glm::dvec3 size(kind % 3 == 2 ? 0.0 : 1.0, kind % 5 == 4 ? 0.0 : 2.0, random.range(0, 3));
    const glm::dvec3 place = random.range(0, kind % 7 == 6 ? 1000 : 5) * random.direction();
    const int count = 4 + static_cast<int>(random.below(200));
    for (int i = 0; i < count; ++i) {
      glm::dvec3 p(random.range(-1, 1), random.range(-1, 1), random.range(-1, 1));
      if (kind % 4 == 1) p = glm::round(p * 2.0) / 2.0;
      if (kind % 4 == 2) p = random.direction();
      p *= size;
      points.emplace_back(place + (kind % 2 == 0 ? turn * p : p));
    }
  }
  return all;
}

double most_outside(const ConvexHull& hull, const std::vector<glm::vec3>& points) {
  double worst = 0.0;
  for (const glm::uvec3& f : hull.faces) {
    const glm::dvec3 a(hull.vertices[f.x]),
        n = glm::cross(glm::dvec3(hull.vertices[f.y]) - a, glm::dvec3(hull.vertices[f.z]) - a);
    const double length = glm::length(n), longest = std::max(glm::distance(hull.vertices[f.x], hull.vertices[f.y]),
                                                             glm::distance(hull.vertices[f.x], hull.vertices[f.z]));
    if (!(length > 1e-2 * longest * longest)) continue;  // the plane of a sliver says nothing
    for (const glm::vec3& p : points) worst = std::max(worst, glm::dot(n / length, glm::dvec3(p) - a));
  }
  return worst;
}

TEST(Hull, HoldsItsPoints) {
  for (const auto& points : clouds()) {
    const ConvexHull hull = convex_hull(points);
    float size = 1e-6f;
    for (const glm::vec3& p : points) size = std::max(size, glm::length(p));
    // The faces of a flat set are tilted by rounding; there the reach below is what counts.
    if (volume(hull) > 1e-4 * std::pow(size, 3)) {
      EXPECT_LE(most_outside(hull, points), static_cast<double>(hull.slack) + 4e-6 * size);
    }
    Random random(7);
    for (int i = 0; i < 60 && !points.empty(); ++i) {  // in every direction the hull reaches as far as the points
      const glm::dvec3 d = random.direction();
      double hull_reach = -1e30, reach = -1e30;
      for (const glm::vec3& p : points) reach = std::max(reach, glm::dot(d, glm::dvec3(p)));
      for (const glm::vec3& p : hull.vertices) hull_reach = std::max(hull_reach, glm::dot(d, glm::dvec3(p)));
      EXPECT_GE(hull_reach + static_cast<double>(hull.slack) + 1e-12, reach);
      EXPECT_LE(hull_reach, reach + 1e-12);
    }
  }
}

TEST(Hull, KnownVolumes) {
  std::vector<glm::vec3> cube;
  for (int i = 0; i < 8; ++i) cube.push_back(Aabb{glm::vec3(0), glm::vec3(2, 3, 4)}.corner(i));
  cube.emplace_back(1, 1, 1);
  cube.emplace_back(1, 1, 4);  // on a face
  const ConvexHull hull = convex_hull(cube);
  EXPECT_EQ(hull.vertices.size(), 8u);
  EXPECT_NEAR(volume(hull), 24.0, 1e-9);
  EXPECT_NEAR(surface(hull), 2 * (6 + 8 + 12), 1e-9);
  const ConvexHull square =
      convex_hull(std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5f, 0.5f, 0}});
  EXPECT_EQ(square.vertices.size(), 4u);
  EXPECT_EQ(volume(square), 0.0);
  EXPECT_NEAR(surface(square), 2.0, 1e-12);  // both sides
  EXPECT_NEAR(convex_area(std::vector<glm::dvec2>{{0, 0}, {2, 0}, {1, 0.2}, {2, 2}, {0, 2}}), 4.0, 1e-12);
}

TEST(Sphere, SmallestIsSmallestAndHoldsAll) {
  Random random(4);
  for (const auto& points : clouds()) {
    const Sphere smallest = smallest_sphere(points), quick = ritter_sphere(points);
    if (points.empty()) {
      EXPECT_LT(smallest.radius, 0.0f);
      continue;
    }
    for (const glm::vec3& p : points)
      for (const Sphere& s : {smallest, quick})
        EXPECT_LE(glm::distance(glm::dvec3(p), glm::dvec3(s.centre)), static_cast<double>(s.radius));
    EXPECT_LE(smallest.radius, quick.radius * 1.0001f + 1e-6f);
    // Minimal: moving the centre anywhere makes the farthest point farther.
    for (int i = 0; i < 30; ++i) {
      const glm::dvec3 other = glm::dvec3(smallest.centre) +
                               static_cast<double>(smallest.radius) * random.range(0.001, 0.3) * random.direction();
      double farthest = 0.0;
      for (const glm::vec3& p : points) farthest = std::max(farthest, glm::distance(other, glm::dvec3(p)));
      EXPECT_GE(farthest,
                static_cast<double>(smallest.radius) * (1 - 1e-6) - 1e-6 * glm::length(glm::dvec3(smallest.centre)));
    }
  }
  const Sphere cube =
      smallest_sphere(std::vector<glm::vec3>{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {2, 2, 2}, {2, 2, 0}});
  EXPECT_NEAR(cube.radius, std::sqrt(3.0), 1e-5);
}

/// 20.10 with E40's quantifiers, and its counter-example: outside near an edge, though not outside of a single plane.
TEST(Sphere, FrustumTest) {
  View view = look_along({0, 0, 0}, {0, 0, -1});
  view.width = view.height = 100;
  view.fov_y = std::acos(0.0);  // the side planes are at 45 degrees
  view.near = 1;
  view.far = 10;
  const Frustum frustum = view_frustum(view, 20);
  EXPECT_EQ(classify(frustum, Sphere{{0, 0, -5}, 1}), Containment::inside);
  EXPECT_EQ(classify(frustum, Sphere{{5, 0, -5}, 1}), Containment::intersecting);
  EXPECT_EQ(classify(frustum, Sphere{{8, 0, -5}, 1}), Containment::outside);
  EXPECT_EQ(classify(frustum, Sphere{{0, 0, 3}, 1}), Containment::outside);
  EXPECT_EQ(classify(frustum, Sphere{{0, 0, -5}, 100}), Containment::intersecting);  // encloses the frustum (20.11)
  EXPECT_EQ(classify(frustum, Sphere{{0, 0, -5}, -1}), Containment::outside);        // empty
  const Sphere corner{{10.9f, 10.9f, -10.9f}, 1};  // beyond a corner of the far plane: false-visible (E41)
  EXPECT_EQ(classify(frustum, corner), Containment::intersecting);
  EXPECT_GT(glm::distance(corner.centre, glm::vec3(10, 10, -10)), 1.0f);
}

TEST(Obb, HoldsItsPointsAndMatrixIsTheBox) {
  for (const auto& points : clouds()) {
    const ConvexHull hull = convex_hull(points);
    const Obb boxes[] = {pca_box(points), fitted_box(hull), box_along(points, glm::dmat3(1.0))};
    for (const Obb& box : boxes) {
      if (points.empty()) {
        EXPECT_LT(box.radii.x, 0.0f);
        continue;
      }
      for (const glm::vec3& p : points)
        for (int axis = 0; axis < 3; ++axis)
          EXPECT_LE(std::abs(glm::dot(glm::dvec3(box.axes[axis]), glm::dvec3(p) - glm::dvec3(box.centre))),
                    static_cast<double>(box.radii[axis]) + 1e-12);
      EXPECT_NEAR(glm::determinant(box.axes), glm::determinant(box.axes) > 0 ? 1.0 : -1.0, 1e-5);
      for (int i = 0; i < 8; ++i) {  // 20.04: T R S takes the unit cube to the box
        const glm::vec3 unit((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
        EXPECT_LE(glm::distance(transform_point(box.matrix(), unit), box.corner(i)),
                  1e-4f * (1 + glm::length(box.centre)));
      }
    }
    for (const int other : {0, 2}) {  // no larger than the others, which know nothing of the hull's slack
      Obb grown = boxes[other];
      if (grown.radii.x >= 0.0f) grown.radii += glm::vec3(hull.slack);
      EXPECT_LE(volume(boxes[1]), volume(grown) * 1.001 + 1e-9);
    }
  }
}

/// The fitted box finds a turned box again, where the principal axes of unevenly spread points do not.
TEST(Obb, FitFindsATurnedBox) {
  Random random(9);
  for (int round = 0; round < 20; ++round) {
    const glm::dmat3 turn = glm::mat3_cast(glm::angleAxis(random.range(0, 6), random.direction()));
    std::vector<glm::vec3> points;
    for (int i = 0; i < 8; ++i)
      points.emplace_back(turn * glm::dvec3((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 2 : -2, (i & 4) != 0 ? 3 : -3));
    for (int i = 0; i < 50; ++i)
      points.emplace_back(turn * glm::dvec3(random.range(0.5, 1), random.range(0.5, 2), random.range(-3, -2)));
    EXPECT_NEAR(volume(fitted_box(convex_hull(points))), 48.0, 0.05);
    EXPECT_GT(volume(pca_box(points)), 48.5);
  }
}

TEST(Kdop, HoldsItsPointsAndPolytopeAgrees) {
  for (const auto& points : clouds())
    for (const int k : {6, 14, 18, 26}) {
      const Kdop kdop = make_kdop(points, k);
      if (points.empty()) {
        EXPECT_EQ(kdop.k, 0);
        continue;
      }
      const auto directions = kdop_directions(k);
      EXPECT_EQ(directions.size() * 2, static_cast<std::size_t>(k));
      const ConvexHull solid = polytope(kdop);
      ASSERT_FALSE(solid.vertices.empty());
      for (std::size_t i = 0; i < directions.size(); ++i) {
        float lo = 1e30f, hi = -1e30f;
        for (const glm::vec3& p : points) {
          EXPECT_LE(static_cast<double>(kdop.lo[i]), glm::dot(glm::dvec3(directions[i]), glm::dvec3(p)));
          EXPECT_GE(static_cast<double>(kdop.hi[i]), glm::dot(glm::dvec3(directions[i]), glm::dvec3(p)));
        }
        for (const glm::vec3& p : solid.vertices) {
          lo = std::min(lo, glm::dot(directions[i], p));
          hi = std::max(hi, glm::dot(directions[i], p));
        }
        // Every slab is touched, as it is the tightest one.
        const float close = 1e-4f * (1 + glm::length(points[0]));
        EXPECT_NEAR(lo, kdop.lo[i], close);
        EXPECT_NEAR(hi, kdop.hi[i], close);
      }
      EXPECT_TRUE(overlaps(kdop, kdop));
    }
}

TEST(Kdop, MoreDirectionsAreTighter) {
  Random random(5);
  std::vector<glm::vec3> ball;
  for (int i = 0; i < 3000; ++i) ball.emplace_back(random.direction());
  const double v6 = volume(polytope(make_kdop(ball, 6))), v14 = volume(polytope(make_kdop(ball, 14))),
               v18 = volume(polytope(make_kdop(ball, 18))), v26 = volume(polytope(make_kdop(ball, 26))),
               hull = volume(convex_hull(ball));
  EXPECT_NEAR(v6, 8.0, 0.05);
  EXPECT_GT(v6, v14);
  EXPECT_GT(v14, v26);
  EXPECT_GT(v18, v26);
  EXPECT_GT(v26, hull);
  EXPECT_NEAR(hull, 4.18879, 0.05);
  EXPECT_FALSE(overlaps(make_kdop(std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 18),
                        make_kdop(std::vector<glm::vec3>{{1, 1, 0}, {0.9f, 0.9f, 0}}, 18)));
}

/// No test calls a volume outside that holds a point inside of the frustum.
TEST(Bounds, FrustumTestsLoseNothing) {
  Random random(11);
  std::size_t outside = 0, checked = 0;
  for (const auto& points : clouds()) {
    if (points.empty()) continue;
    const ConvexHull hull = convex_hull(points);
    const Sphere sphere = smallest_sphere(points);
    const Obb box = fitted_box(hull);
    const ConvexHull dop = polytope(make_kdop(points, 26));
    for (int i = 0; i < 40; ++i) {
      View view = look_along(glm::dvec3(points[0]) + random.range(0, 8) * random.direction(), random.direction());
      view.fov_y = random.range(0.1, 2.0);
      view.far = random.range(1, 20);
      const Frustum frustum = view_frustum(view, 2000);
      const glm::dmat4 clip = view_projection(view);
      bool inside = false;
      for (const glm::vec3& p : points) {
        const glm::dvec4 q = clip * glm::dvec4(glm::dvec3(p), 1.0);
        inside = inside || (q.w > 0 && std::abs(q.x) < q.w && std::abs(q.y) < q.w && std::abs(q.z) < q.w);
      }
      const Containment answers[] = {classify(frustum, hull.vertices, hull.slack), classify(frustum, sphere),
                                     classify(frustum, box), classify(frustum, dop.vertices, dop.slack)};
      ++checked;
      for (const Containment answer : answers) {
        if (inside) {
          EXPECT_NE(answer, Containment::outside);
        }
        outside += answer == Containment::outside ? 1 : 0;
      }
    }
  }
  EXPECT_GT(outside, checked / 2);
}

/// 20.11: all corners of the box are outside of the frustum, and yet it intersects; it is not called outside. 20.12:
/// the simple test by eight corners gives the p-vertex test's answer.
TEST(Bounds, CornersOutsideAreNoProof) {
  View view = look_along({0, 0, 0}, {0, 0, -1});
  view.width = view.height = 100;
  const Frustum frustum = view_frustum(view, 2000);
  const Aabb wide{{-50, -0.1f, -6}, {50, 0.1f, -5}};
  std::vector<glm::vec3> corners;
  for (int i = 0; i < 8; ++i) corners.push_back(wide.corner(i));
  for (const glm::vec3& p : corners) {
    const glm::dvec4 q = view_projection(view) * glm::dvec4(glm::dvec3(p), 1.0);
    EXPECT_GT(std::abs(q.x), q.w);
  }
  EXPECT_EQ(classify(frustum, corners), Containment::intersecting);
  EXPECT_EQ(classify(frustum, wide), Containment::intersecting);
  Random random(13);
  for (int i = 0; i < 2000; ++i) {
    const glm::vec3 at(random.range(-30, 30), random.range(-30, 30), random.range(-40, 10));
    const Aabb box{at, at + glm::vec3(random.range(0, 9), random.range(0, 9), random.range(0, 9))};
    for (int c = 0; c < 8; ++c) corners[static_cast<std::size_t>(c)] = box.corner(c);
    EXPECT_EQ(classify(frustum, corners), classify(frustum, box));
  }
}

}  // namespace
}  // namespace sightline
