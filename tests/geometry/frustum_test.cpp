// The frustum test of boxes: planes of a clip matrix, p- and n-vertex (checklist 20.10-20.14), and that it never
// rejects what is inside, whatever the coordinates.
#include "sightline/geometry/frustum.hpp"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <vector>

#include "properties.hpp"
#include "sightline/scene/view.hpp"

namespace sightline {
namespace {

// At the origin, along -z, 90 degrees both ways: a point is inside iff 1 <= -z <= 100 and |x|, |y| <= -z.
Frustum pyramid() { return frustum_of(glm::perspective(glm::radians(90.0), 1.0, 1.0, 100.0), 200.0); }

Aabb around(const glm::vec3& centre, const glm::vec3& half) { return {centre - half, centre + half}; }

/// classify by all eight corners (checklist 20.12, 20.13): the slow test that the p- and n-vertices stand for.
Containment by_corners(const Plane& plane, const Aabb& box) {
  int inside = 0;
  for (int i = 0; i < 8; ++i) inside += glm::dot(plane.normal, box.corner(i)) + plane.offset >= 0.0f ? 1 : 0;
  return inside == 8 ? Containment::inside : inside == 0 ? Containment::outside : Containment::intersecting;
}

TEST(Frustum, PlanesPointInwardsAndAreUnit) {
  const Frustum frustum = pyramid();
  ASSERT_EQ(frustum.count, 6);
  for (int i = 0; i < 6; ++i) {
    const Plane& plane = frustum.planes[static_cast<std::size_t>(i)];
    EXPECT_NEAR(glm::length(plane.normal), 1.0f, 1e-6f);
    EXPECT_GT(glm::dot(plane.normal, glm::vec3(0, 0, -50)) + plane.offset, 0.0f) << "plane " << i;
  }
}

TEST(Frustum, BoxesInsideOutsideAndAcross) {
  const Frustum frustum = pyramid();
  EXPECT_EQ(classify(frustum, around({0, 0, -50}, glm::vec3(1))), Containment::inside);
  EXPECT_EQ(classify(frustum, around({0, 0, 50}, glm::vec3(1))), Containment::outside);     // behind the eye
  EXPECT_EQ(classify(frustum, around({0, 0, -102}, glm::vec3(1))), Containment::outside);   // beyond the far plane
  EXPECT_EQ(classify(frustum, around({0, 0, 0}, glm::vec3(0.5f))), Containment::outside);   // before the near plane
  EXPECT_EQ(classify(frustum, around({-60, 0, -50}, glm::vec3(1))), Containment::outside);  // one box past each side
  EXPECT_EQ(classify(frustum, around({60, 0, -50}, glm::vec3(1))), Containment::outside);
  EXPECT_EQ(classify(frustum, around({0, 60, -50}, glm::vec3(1))), Containment::outside);
  EXPECT_EQ(classify(frustum, around({0, -60, -50}, glm::vec3(1))), Containment::outside);
  EXPECT_EQ(classify(frustum, around({50, 0, -50}, glm::vec3(1))), Containment::intersecting);
  EXPECT_EQ(classify(frustum, around({0, 0, -1}, glm::vec3(0.5f))), Containment::intersecting);
  EXPECT_EQ(classify(frustum, around({0, 0, -100}, glm::vec3(0.5f))), Containment::intersecting);
}

TEST(Frustum, BoxThatEnclosesTheFrustumIntersects) {  // checklist 20.11, second counter-example
  EXPECT_EQ(classify(pyramid(), around({0, 0, 0}, glm::vec3(1000))), Containment::intersecting);
}

TEST(Frustum, BoxWithAllCornersOutsideIntersects) {  // checklist 20.11, first counter-example
  const Frustum frustum = pyramid();
  const Aabb beam = around({0, 0, -50}, {500, 1, 1});
  for (int i = 0; i < 8; ++i)
    EXPECT_EQ(classify(frustum, Aabb{beam.corner(i), beam.corner(i)}), Containment::outside) << "corner " << i;
  EXPECT_EQ(classify(frustum, beam), Containment::intersecting);
}

TEST(Frustum, TouchingFromOutsideIsNotOutside) {
  EXPECT_NE(classify(pyramid(), Aabb{{50, 0, -50}, {60, 1, -50}}), Containment::outside);
  EXPECT_NE(classify(pyramid(), Aabb{{0, 0, -1}, {0, 0, 5}}), Containment::outside);
}

TEST(Frustum, InfiniteFarPlaneIsLeftOut) {
  const Frustum frustum = frustum_of(glm::infinitePerspective(glm::radians(90.0), 1.0, 1.0), 2e3);
  ASSERT_EQ(frustum.count, 5);
  EXPECT_EQ(classify(frustum, around({0, 0, -1e3f}, glm::vec3(1))), Containment::inside);
  EXPECT_EQ(classify(frustum, around({0, 0, 50}, glm::vec3(1))), Containment::outside);
  EXPECT_EQ(classify(frustum, around({60, 0, -50}, glm::vec3(1))), Containment::outside);
}

TEST(Frustum, OrthographicVolumeIsABox) {
  const Frustum frustum = frustum_of(glm::ortho(-2.0, 2.0, -1.0, 1.0, 1.0, 10.0), 20.0);
  ASSERT_EQ(frustum.count, 6);
  EXPECT_EQ(classify(frustum, Aabb{{-1.9f, -0.9f, -9.9f}, {1.9f, 0.9f, -1.1f}}), Containment::inside);
  EXPECT_EQ(classify(frustum, Aabb{{2.1f, 0, -5}, {3, 1, -4}}), Containment::outside);
  EXPECT_EQ(classify(frustum, Aabb{{0, 1.1f, -5}, {1, 2, -4}}), Containment::outside);
  EXPECT_EQ(classify(frustum, Aabb{{0, 0, -0.9f}, {1, 1, 0}}), Containment::outside);
}

RC_GTEST_PROP(FrustumProperty, VerticesOfThePlaneStandForAllCorners, ()) {
  const Plane plane{glm::vec3(properties::direction()), static_cast<float>(properties::number(-50, 50))};
  const Aabb box = properties::box(60, 30);
  RC_ASSERT(classify(plane, box) == by_corners(plane, box));
}

/// A clip matrix anywhere in a world of the given reach.
glm::dmat4 random_clip(double reach, double near, double far) {
  const glm::dvec3 eye = properties::point(reach);
  const glm::dmat4 turn = glm::transpose(glm::mat4_cast(properties::rotation()));
  const double aspect = properties::number(0.2, 5.0);
  return glm::perspective(properties::number(0.05, 3.0), aspect, near, far) * turn *
         glm::translate(glm::dmat4(1.0), -eye);
}

/// -1, 1 or between: half of the points of the test below lie on a face, an edge or a corner of the volume.
double clip_coordinate() { return *rc::gen::element(-1.0, 1.0, properties::number(-1, 1), properties::number(-1, 1)); }

RC_GTEST_PROP(FrustumProperty, NeverRejectsABoxWithAPointInside, ()) {
  const double reach = *rc::gen::element(1.0, 1e3, 1e6);
  const glm::dmat4 clip = random_clip(reach, 0.1, 0.5 * reach + 1.0);
  const glm::dmat4 to_world = glm::inverse(clip);
  const Frustum frustum = frustum_of(clip, 4.0 * reach + 2.0);
  for (int i = 0; i < 50; ++i) {
    const glm::dvec4 p = to_world * glm::dvec4(clip_coordinate(), clip_coordinate(), clip_coordinate(), 1.0);
    const glm::vec3 point(glm::dvec3(p) / p.w);
    const glm::dvec4 q = clip * glm::dvec4(point, 1.0);  // rounding may have moved it out
    if (!(std::abs(q.x) <= q.w && std::abs(q.y) <= q.w && std::abs(q.z) <= q.w)) continue;
    const float size = *rc::gen::element(0.0f, 0.0f, 0.1f, 10.0f);
    const Aabb box{point - size * glm::abs(glm::vec3(properties::point(1))),
                   point + size * glm::abs(glm::vec3(properties::point(1)))};
    RC_ASSERT(classify(frustum, box) != Containment::outside);
  }
}

RC_GTEST_PROP(FrustumProperty, InsideMeansEveryCornerInside, ()) {
  const glm::dmat4 clip = random_clip(20.0, 0.5, 100.0);
  const Aabb box = properties::box(40, 10);
  if (classify(frustum_of(clip, 200.0), box) != Containment::inside) return;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec4 p = clip * glm::dvec4(box.corner(i), 1.0);
    const double slack = 1e-3;
    RC_ASSERT(p.w > 0.0);
    RC_ASSERT(std::abs(p.x) <= p.w + slack && std::abs(p.y) <= p.w + slack && std::abs(p.z) <= p.w + slack);
  }
}

RC_GTEST_PROP(FrustumProperty, RejectsMostOfWhatIsOutside, ()) {
  // Small boxes well outside one plane must go: a test that accepted everything would be conservative too.
  const glm::dmat4 clip = random_clip(20.0, 0.5, 100.0);
  const Aabb box = properties::box(300, 1);
  const glm::dvec4 p = clip * glm::dvec4(box.centre(), 1.0);
  const Frustum frustum = frustum_of(clip, 400.0);
  bool far_outside = false;
  for (int i = 0; i < frustum.count; ++i) {
    const Plane& plane = frustum.planes[static_cast<std::size_t>(i)];
    far_outside |= glm::dot(plane.normal, box.centre()) + plane.offset < -2.0f;
  }
  RC_PRE(far_outside);
  RC_ASSERT(!(std::abs(p.x) <= p.w && std::abs(p.y) <= p.w && std::abs(p.z) <= p.w));
  RC_ASSERT(classify(frustum, box) == Containment::outside);
}

RC_GTEST_PROP(FrustumProperty, AFarPlaneThatIsOnlyNoiseCullsNothing, ()) {
  // Far planes up to 1e13 times as far as the near plane: what the matrix in double cannot tell must not cull.
  View view = look_along(properties::point(100), properties::direction());
  view.near = std::pow(10.0, properties::number(-6, 0));
  view.far = view.near * std::pow(10.0, properties::number(3, 13));
  view.width = view.height = 100;
  const double depth = view.near + properties::number(0.001, 0.999) * (view.far - view.near);
  const PixelRay ray = pixel_ray(view, properties::number(1, 99), properties::number(1, 99));
  const glm::vec3 point(ray.origin + depth * ray.direction);
  const Frustum frustum = view_frustum(view, reach(Aabb{point, point}));
  RC_ASSERT(classify(frustum, Aabb{point, point}) != Containment::outside);
}

}  // namespace
}  // namespace sightline
