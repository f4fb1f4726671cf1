// Wall fences and the occlusion horizon (checklist 21.03): which walls of a mesh are proven, and what they hide.
#include "sightline/raster/horizon.hpp"

#include <gtest/gtest.h>

#include "agreement/cases.hpp"
#include "sightline/raster/wall_fences.hpp"

namespace sightline {
namespace {

WallFences fences_of(const Mesh& mesh, const glm::dmat3& linear = glm::dmat3(1.0)) {
  return find_wall_fences(mesh, linear);
}

std::size_t walls(const WallFences& set) {
  std::size_t count = 0;
  for (const WallFence& fence : set.fences) count += fence.plan.size() - 1;
  return count;
}

TEST(WallFences, ACubeIsALoopOfFourWalls) {
  const WallFences set = fences_of(cases::cube());
  ASSERT_EQ(set.fences.size(), 1u);
  EXPECT_EQ(set.fences[0].plan.size(), 5u);
  EXPECT_EQ(set.fences[0].plan.front(), set.fences[0].plan.back());
  EXPECT_NEAR(set.fences[0].y0, -0.5, 1e-5);
  EXPECT_NEAR(set.fences[0].y1, 0.5, 1e-5);
}

TEST(WallFences, UprightIsWhatTheTransformMakesUpright) {
  const Mesh floor = cases::quad({0, 0, 0}, {4, 0, 0}, {0, 0, 4});
  EXPECT_EQ(walls(fences_of(floor)), 0u);
  EXPECT_EQ(walls(fences_of(floor, glm::dmat3(1, 0, 0, 0, 0, 1, 0, 1, 0))), 1u);
  const Mesh wall = cases::quad({0, 0, 0}, {4, 0, 0}, {0, 3, 0});
  EXPECT_EQ(walls(fences_of(wall)), 1u);
  EXPECT_EQ(walls(fences_of(wall, glm::dmat3(glm::mat3_cast(glm::angleAxis(0.1, glm::dvec3(1, 0, 0)))))), 0u);
  EXPECT_EQ(walls(fences_of(cases::quad({0, 0, 0}, {4, 0.5f, 0}, {0, 3, 0}))), 1u)
      << "a leaning outline keeps its rectangle";
}

// A gable: the rectangle under the eaves is kept. A wall with a window in it, and one with a notch, are not.
TEST(WallFences, OnlySolidRectanglesAreKept) {
  Mesh gable{
      "gable", {{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {2, 5, 0}, {0, 3, 0}}, {{0, 1, 2}, {0, 2, 4}, {4, 2, 3}}, false, {}};
  const WallFences set = fences_of(gable);
  ASSERT_EQ(walls(set), 1u);
  EXPECT_NEAR(set.fences[0].y1, 3, 1e-4);
  Mesh window;
  for (const float y : {0.0f, 1.0f, 2.0f, 3.0f})
    for (const float x : {0.0f, 1.0f, 2.0f, 3.0f}) window.positions.emplace_back(x, y, 0);
  for (std::uint32_t j = 0; j < 3; ++j)
    for (std::uint32_t i = 0; i < 3; ++i) {
      if (i == 1 && j == 1) continue;
      const std::uint32_t a = 4 * j + i;
      window.triangles.push_back({a, a + 1, a + 5});
      window.triangles.push_back({a, a + 5, a + 4});
    }
  EXPECT_EQ(walls(fences_of(window)), 0u);
  window.triangles.clear();
  for (const std::uint32_t a : {0u, 1u, 2u, 4u, 8u, 9u, 10u}) {  // a notch from the right
    window.triangles.push_back({a, a + 1, a + 5});
    window.triangles.push_back({a, a + 5, a + 4});
  }
  EXPECT_EQ(walls(fences_of(window)), 0u);
  Mesh torn = cases::quad({0, 0, 0}, {4, 0, 0}, {0, 3, 0});
  torn.triangles.pop_back();
  EXPECT_EQ(walls(fences_of(torn)), 0u);
  EXPECT_EQ(walls(fences_of({"empty", {}, {}, false, {}})), 0u);
}

View street(double eye_height = 1.7, double pitch = 0) {
  View view = look_along({0, eye_height, 0}, {0, pitch, -1});
  view.width = 320;
  view.height = 180;
  return view;
}

Aabb box(float x0, float x1, float y0, float y1, float z0, float z1) { return {{x0, y0, -z1}, {x1, y1, -z0}}; }

WallFence wall(double x0, double x1, double y0, double y1, double z) { return {{{x0, -z}, {x1, -z}}, y0, y1}; }

bool hidden(const Horizon& horizon, const Aabb& b) {
  std::uint64_t cells = 0;
  return horizon.hides(horizon.query(horizon.project(b)), cells);
}

TEST(Horizon, AWallHidesWhatStandsBehindItBelowItsTop) {
  for (const double pitch : {0.0, 0.4, -0.4}) {
    Horizon horizon;
    ASSERT_TRUE(horizon.begin(street(1.7, pitch), 320));
    EXPECT_FALSE(hidden(horizon, box(-1, 1, 0, 3, 20, 22)));
    horizon.add(wall(-10, 10, 0, 8, 10), glm::dvec3(0), 0);
    EXPECT_TRUE(hidden(horizon, box(-1, 1, 0, 3, 20, 22)));
    EXPECT_TRUE(hidden(horizon, box(-1, 1, 0, 13.5f, 20, 22))) << "the line over the wall rises to 14.3 m at 20 m";
    EXPECT_FALSE(hidden(horizon, box(-1, 1, 0, 15, 20, 22)));
    EXPECT_FALSE(hidden(horizon, box(18, 22, 0, 3, 20, 22))) << "reaches beside the wall";
    EXPECT_FALSE(hidden(horizon, box(-1, 1, -3, 3, 20, 22))) << "a wall that ends at 0 m hides no cellar";
  }
}

// The picture of 21.03: near small houses, a tower behind them that stands out, and what is in the tower's shadow.
TEST(Horizon, RisesFrontToBack) {
  Horizon horizon;
  ASSERT_TRUE(horizon.begin(street(), 640));
  for (int i = -6; i < 6; ++i) horizon.add(wall(4 * i, 4 * i + 4, 0, 5, 10), glm::dvec3(0), 0);
  const Aabb tower = box(-5, 5, 0, 60, 50, 60), shade = box(-4, 4, 0, 40, 80, 90), beside = box(8, 12, 0, 60, 80, 90);
  EXPECT_FALSE(hidden(horizon, tower));
  EXPECT_FALSE(hidden(horizon, shade));
  horizon.add(wall(-5, 5, 0, 60, 50), glm::dvec3(0), 0);
  EXPECT_TRUE(hidden(horizon, shade));
  EXPECT_FALSE(hidden(horizon, beside));
}

// Something that floats must not hide what is seen below it: the interval does not reach the ground by itself.
TEST(Horizon, ABridgeHidesNothingUnderIt) {
  Horizon horizon;
  ASSERT_TRUE(horizon.begin(street(), 320));
  horizon.add(wall(-20, 20, 5, 9, 10), glm::dvec3(0), 0);
  EXPECT_FALSE(hidden(horizon, box(-1, 1, 0, 3, 20, 22)));
  EXPECT_TRUE(hidden(horizon, box(-1, 1, 9, 14, 20, 22)));
  horizon.add(wall(-20, 20, 0, 5.1, 10), glm::dvec3(0), 0);
  EXPECT_TRUE(hidden(horizon, box(-1, 1, 0, 14, 20, 22))) << "the two intervals touch";
}

TEST(Horizon, WallsBeforeTheNearPlaneOrBehindTheEyeAreLeftOut) {
  Horizon horizon;
  View view = street();
  view.near = 12;
  ASSERT_TRUE(horizon.begin(view, 320));
  horizon.add(wall(-10, 10, 0, 8, 10), glm::dvec3(0), 0);
  horizon.add(wall(-10, 10, 0, 8, -10), glm::dvec3(0), 0);
  EXPECT_FALSE(hidden(horizon, box(-1, 1, 0, 3, 20, 22)));
  WallFence through{{{-10, 10}, {-10, -30}, {10, -30}, {10, 10}, {-10, 10}}, 0, 8};
  horizon.add(through, glm::dvec3(0), 0);
  EXPECT_FALSE(hidden(horizon, box(-1, 1, 0, 3, 20, 22)));
  EXPECT_TRUE(hidden(horizon, box(-1, 1, 0, 3, 40, 42)));
}

TEST(Horizon, ThereIsNoneStraightDownAndOneForOrthographicViews) {
  Horizon horizon;
  View view = street();
  view.orientation = look_along({0, 0, 0}, {0, -1, 0}).orientation;
  EXPECT_FALSE(horizon.begin(view, 320));
  view = street(10, -0.5);
  view.projection = Projection::orthographic;
  view.span_y = 40;
  ASSERT_TRUE(horizon.begin(view, 320));
  horizon.add(wall(-10, 10, 0, 12, 10), glm::dvec3(0), 0);
  EXPECT_TRUE(hidden(horizon, box(-5, 5, 0, 4, 14, 16))) << "below the line that falls by half a metre each metre";
  EXPECT_FALSE(hidden(horizon, box(-5, 5, 0, 11.5f, 14, 16)));
}

}  // namespace
}  // namespace sightline
