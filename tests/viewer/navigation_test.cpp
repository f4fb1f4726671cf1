// Moving through a scene: what keys and drags do to the camera, and that every camera they lead to is a valid view.
#include "viewer/navigation.hpp"

#include <gtest/gtest.h>

#include "viewer/standing.hpp"

namespace sightline::viewer {
namespace {

Aabb box() { return {{-4, 0, -4}, {4, 3, 4}}; }

View start() {
  View view = look_along({0, 2, 10}, {0, 0, -1});
  view.width = 640;
  view.height = 360;
  return view;
}

bool sees(const View& view, const glm::vec3& point) {
  const glm::dvec4 clip = view_projection(view) * glm::dvec4(point, 1.0);
  return std::abs(clip.x) <= clip.w && std::abs(clip.y) <= clip.w && std::abs(clip.z) <= clip.w;
}

TEST(Navigation, StartsWhereItIsTold) {
  const Navigation navigation(start(), box());
  const View view = navigation.view(640, 360);
  EXPECT_NEAR(glm::length(view.eye - start().eye), 0.0, 1e-6);
  EXPECT_NEAR(glm::dot(view_direction(view), glm::dvec3(0, 0, -1)), 1.0, 1e-9);
  EXPECT_EQ(view.width, 640);
}

TEST(Navigation, FlyingGoesWhereTheKeysSay) {
  Navigation navigation(start(), box());
  Motion motion;
  motion.forward = true;
  navigation.fly(motion, 0.5);
  EXPECT_LT(navigation.view(1, 1).eye.z, 10.0);
  EXPECT_NEAR(navigation.view(1, 1).eye.x, 0.0, 1e-6);
  motion = {};
  motion.right = true;
  navigation.fly(motion, 0.5);
  EXPECT_GT(navigation.view(1, 1).eye.x, 0.0);
  Navigation slow(start(), box()), fast(start(), box());
  slow.fly(motion, 0.5);
  motion.fast = true;
  fast.fly(motion, 0.5);
  EXPECT_GT(fast.view(1, 1).eye.x, 2.0 * slow.view(1, 1).eye.x);
}

TEST(Navigation, OrbitKeepsTheDistanceToThePivotAndLooksAtIt) {
  Navigation navigation(start(), box());
  navigation.set_pivot({1, 1, 0});
  const double before = glm::length(navigation.view(1, 1).eye - navigation.pivot());
  for (int i = 0; i < 40; ++i) navigation.orbit(37, i % 2 == 0 ? 90 : -20);
  const View view = navigation.view(1, 1);
  EXPECT_NEAR(glm::length(view.eye - navigation.pivot()), before, 1e-4);
  EXPECT_NEAR(glm::dot(view_direction(view), glm::normalize(navigation.pivot() - view.eye)), 1.0, 1e-6);
}

TEST(Navigation, FramingShowsTheWholeBox) {
  for (const Projection projection : {Projection::perspective, Projection::orthographic})
    for (const int width : {200, 640, 1600}) {
      View view = start();
      view.projection = projection;
      Navigation navigation(view, box());
      navigation.turn(333, 77);
      navigation.frame(box(), width / 360.0);
      const View framed = navigation.view(width, 360);
      for (int corner = 0; corner < 8; ++corner) EXPECT_TRUE(sees(framed, box().corner(corner))) << width;
      navigation.overview(box(), width / 360.0);
      const View above = navigation.view(width, 360);
      for (int corner = 0; corner < 8; ++corner) EXPECT_TRUE(sees(above, box().corner(corner))) << width;
      EXPECT_GT(above.eye.y, box().hi.y);
    }
}

TEST(Navigation, EveryCameraIsAValidView) {
  for (const Aabb& scene : {box(), Aabb(), Aabb{{0, 0, 0}, {0, 0, 0}}}) {
    Navigation navigation(start(), scene);
    for (int i = 0; i < 300; ++i) {
      navigation.turn(400, 500 - i * 3);
      navigation.dolly(i % 7 - 3);
      if (i % 50 == 0) navigation.frame(scene, 1.5);
      EXPECT_NO_THROW(check_view(navigation.view(i, 2 * i)));
    }
    View flat = start();
    flat.projection = Projection::orthographic;
    for (const View& from : {start(), flat})
      for (const double notches : {3.0, -3.0}) {
        Navigation zoom(from, scene);
        for (int i = 0; i < 500; ++i) zoom.dolly(notches);
        EXPECT_NO_THROW(check_view(zoom.view(10, 10)));
        for (int i = 0; i < 500; ++i) zoom.dolly(-notches);
        EXPECT_NO_THROW(check_view(zoom.view(10, 10)));
      }
  }
}

TEST(Standing, SaysWhatBecameOfEachObject) {
  VisibleSet frustum(5), large(5), visible(5);
  for (const ObjectId id : {0u, 1u, 2u}) frustum.insert(id);
  for (const ObjectId id : {0u, 1u}) large.insert(id);
  visible.insert(0);
  const auto all = standings(frustum, &large, visible);
  EXPECT_EQ(all,
            (std::vector{Standing::seen, Standing::occluded, Standing::detail, Standing::outside, Standing::outside}));
  EXPECT_EQ(count(all), (std::array<std::size_t, 4>{1, 2, 1, 1}));
  EXPECT_EQ(standings(frustum, nullptr, visible)[2], Standing::occluded);
  const auto colours = colours_of(all);
  EXPECT_EQ(colours[0], looks[0].colour);
  EXPECT_NE(colours[0], colours[1]);
}

}  // namespace
}  // namespace sightline::viewer
