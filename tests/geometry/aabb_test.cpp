// Axis-aligned boxes: what is empty, what contains what.
#include "sightline/geometry/aabb.hpp"

#include <gtest/gtest.h>

#include "properties.hpp"

namespace sightline {
namespace {

TEST(Aabb, DefaultIsEmptyAndNeutral) {
  const Aabb none;
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(none.half_area(), 0.0f);
  EXPECT_EQ(reach(none), 0.0f);
  Aabb box{{-1, -2, -3}, {4, 5, 6}};
  const Aabb before = box;
  box.extend(none);
  EXPECT_EQ(box, before);
  EXPECT_FALSE(none.overlaps(box));
  EXPECT_FALSE(box.overlaps(none));
}

TEST(Aabb, ExtendingAnEmptyBoxGivesThePoint) {
  Aabb box;
  box.extend(glm::vec3(1, -2, 3));
  EXPECT_EQ(box, (Aabb{{1, -2, 3}, {1, -2, 3}}));
  EXPECT_FALSE(box.empty());
  EXPECT_EQ(box.half_area(), 0.0f);
}

TEST(Aabb, MeasuresAreExactOnIntegers) {
  const Aabb box{{-1, 0, 2}, {3, 6, 5}};
  EXPECT_EQ(box.centre(), glm::vec3(1, 3, 3.5f));
  EXPECT_EQ(box.extent(), glm::vec3(4, 6, 3));
  EXPECT_EQ(box.half_area(), 4 * 6 + 6 * 3 + 3 * 4);
  EXPECT_EQ(reach(box), 6.0f);
  EXPECT_EQ(reach(Aabb{{-9, 0, 0}, {1, 1, 1}}), 9.0f);
}

TEST(Aabb, CornersFollowTheirBits) {
  const Aabb box{{1, 2, 3}, {4, 5, 6}};
  EXPECT_EQ(box.corner(0), box.lo);
  EXPECT_EQ(box.corner(1), glm::vec3(4, 2, 3));
  EXPECT_EQ(box.corner(2), glm::vec3(1, 5, 3));
  EXPECT_EQ(box.corner(4), glm::vec3(1, 2, 6));
  EXPECT_EQ(box.corner(7), box.hi);
}

TEST(Aabb, BoxesAreClosed) {
  const Aabb a{{0, 0, 0}, {1, 1, 1}}, touching{{1, 0, 0}, {2, 1, 1}}, apart{{1.5f, 0, 0}, {2, 1, 1}};
  EXPECT_TRUE(a.overlaps(touching));
  EXPECT_FALSE(a.overlaps(apart));
  EXPECT_TRUE(a.contains(a));
  EXPECT_TRUE(a.contains(glm::vec3(1, 1, 1)));
  EXPECT_FALSE(a.contains(glm::vec3(1, 1, 1.0001f)));
}

RC_GTEST_PROP(AabbProperty, UnionContainsBothAndNothingLess, ()) {
  const Aabb a = properties::box(100, 50), b = properties::box(100, 50);
  Aabb both = a;
  both.extend(b);
  RC_ASSERT(both.contains(a));
  RC_ASSERT(both.contains(b));
  for (int axis = 0; axis < 3; ++axis) {
    RC_ASSERT(both.lo[axis] == a.lo[axis] || both.lo[axis] == b.lo[axis]);
    RC_ASSERT(both.hi[axis] == a.hi[axis] || both.hi[axis] == b.hi[axis]);
  }
}

RC_GTEST_PROP(AabbProperty, OverlapIsSymmetricAndMeansACommonPoint, ()) {
  const Aabb a = properties::box(20, 20), b = properties::box(20, 20);
  RC_ASSERT(a.overlaps(b) == b.overlaps(a));
  const Aabb common{glm::max(a.lo, b.lo), glm::min(a.hi, b.hi)};
  RC_ASSERT(a.overlaps(b) == !common.empty());
}

}  // namespace
}  // namespace sightline
