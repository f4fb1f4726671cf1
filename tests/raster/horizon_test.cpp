// Wall fences and the occlusion horizon (checklist 21.03): which walls of a mesh are proven, and what they hide.
#include "sightline/raster/horizon.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "agreement/cases.hpp"
#include "sightline/raster/wall_fences.hpp"
#include "sightline/scene/generate/random.hpp"

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
  const BoxArrays boxes(std::span(&b, 1));
  HorizonBox over;
  Counters unused;
  return boxes_over_horizon(horizon.plan(), boxes, 0, 1, {}, -std::numeric_limits<float>::infinity(), &over, unused) ==
         0;
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

View random_view(Random& random, int i) {
  View view = look_along({random.range(-50, 50), random.range(-50, 50), random.range(-50, 50)}, random.direction());
  view.fov_y = random.range(0.2, 2.4);
  if (i % 3 == 1) view.eye += glm::dvec3(1e-7, 2e-7, -3e-7);  // no float
  if (i % 4 == 1) {
    view.projection = Projection::orthographic;
    view.span_y = random.range(5, 90);
    view.far = 200;
  }
  return view;
}

std::vector<Aabb> random_boxes(Random& random, std::size_t count) {
  std::vector<Aabb> boxes(count);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 at(random.range(-90, 90), random.range(-90, 90), random.range(-90, 90));
    if (i % 17 != 5) boxes[i] = {at, at + glm::vec3(random.range(0, 9), random.range(0, 9), random.range(0, 9))};
  }
  return boxes;
}

std::vector<HorizonBox> boxes_over(const HorizonPlan& plan, const BoxArrays& boxes, const Frustum& frustum) {
  std::vector<HorizonBox> over(boxes.count);
  Counters unused;
  over.resize(boxes_over_horizon(plan, boxes, 0, boxes.count, frustum, 0, over.data(), unused));
  return over;
}

TEST(Horizon, BoxesAreRoundedOutwards) {
  Random random(5);
  std::size_t asked = 0;
  for (int i = 0; i < 200; ++i) {
    const View view = random_view(random, i);
    const std::vector<Aabb> boxes = random_boxes(random, 70);
    Horizon horizon;
    if (!horizon.begin(view, 1 << (4 + i % 11))) continue;
    const HorizonPlan& plan = horizon.plan();
    const bool perspective = view.projection == Projection::perspective;
    std::size_t empty = 0;
    for (const Aabb& b : boxes) empty += b.empty() ? 1 : 0;
    const std::vector<HorizonBox> over = boxes_over(plan, BoxArrays(boxes), {});
    EXPECT_EQ(over.size() + empty, boxes.size()) << "nothing is hidden yet";
    for (const HorizonBox& box : over) {
      const bool asks = box.first <= box.last;
      asked += asks ? 1 : 0;
      for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 d = glm::dvec3(boxes[box.index].corner(corner)) - view.eye;
        const double along = glm::dot(plan.forward, glm::dvec2(d.x, d.z)),
                     across = glm::dot(plan.right, glm::dvec2(d.x, d.z));
        EXPECT_LE(static_cast<double>(box.nearest), along);
        EXPECT_GE(static_cast<double>(box.farthest), along);
        if (!asks) continue;
        const double u = perspective ? across / along : across,
                     slope = perspective ? d.y / along : d.y - plan.tilt * along;
        EXPECT_TRUE(box.first == 0 || horizon.border(box.first) <= u);
        EXPECT_TRUE(box.last + 1 == horizon.columns() || horizon.border(box.last + 1) >= u);
        EXPECT_LE(static_cast<double>(box.low), slope);
        EXPECT_GE(static_cast<double>(box.high), slope);
      }
    }
  }
  EXPECT_GT(asked, 3000u);
}

TEST(Horizon, EveryTargetGivesTheSameBits) {
  std::vector<std::vector<float>> answers;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().DeInit();
    Random random(6);
    std::vector<float>& answer = answers.emplace_back();
    for (int i = 0; i < 60; ++i) {
      const View view = random_view(random, i);
      const BoxArrays boxes(random_boxes(random, static_cast<std::size_t>(i)));
      Horizon horizon;
      if (!horizon.begin(view, 16 + i)) continue;
      for (int w = 0; w < 20; ++w) {
        WallFence fence{{}, random.range(-60, 0), random.range(0, 60)};
        for (int k = 0; k <= w % 6; ++k) fence.plan.emplace_back(random.range(-40, 40), random.range(-40, 40));
        horizon.add(fence, {random.range(-40, 40), 1, random.range(-40, 40)}, 1e-5);
      }
      for (int c = 0; c < horizon.columns(); ++c) {
        answer.push_back(horizon.low(c));
        answer.push_back(horizon.high(c));
      }
      for (const HorizonBox& b : boxes_over(horizon.plan(), boxes, view_frustum(view, 200)))
        for (const float f : {static_cast<float>(b.index), b.nearest, b.farthest, static_cast<float>(b.first),
                              static_cast<float>(b.last), b.low, b.high})
          answer.push_back(f);
    }
    EXPECT_EQ(answer, answers[0]) << hwy::TargetName(target);
  }
  EXPECT_GT(answers[0].size(), 2000u);
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
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
