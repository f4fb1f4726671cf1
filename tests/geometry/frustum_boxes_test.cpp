// SIMD against the one-by-one reference: every target, every tail size, empty boxes, infinite far planes.
#include "sightline/geometry/frustum_boxes.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/view.hpp"

namespace sightline {
namespace {

std::vector<Aabb> random_boxes(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Aabb> boxes(count);
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 at(random.range(-50, 50), random.range(-50, 50), random.range(-50, 50));
    if (i % 17 != 5) boxes[i] = {at, at + glm::vec3(random.range(0, 9), random.range(0, 9), random.range(0, 9))};
  }
  return boxes;
}

std::vector<std::uint32_t> found(const BoxArrays& boxes, const Frustum& frustum,
                                 std::size_t (*test)(const BoxArrays&, const Frustum&, std::uint32_t*)) {
  std::vector<std::uint32_t> ids(boxes.count + 64);
  ids.resize(test(boxes, frustum, ids.data()));
  return ids;
}

TEST(FrustumBoxes, EveryTargetAndTailGivesTheReferencesAnswer) {
  Random random(3);
  std::size_t inside = 0, all = 0;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().DeInit();
    for (std::size_t count = 0; count < 70; ++count) {
      const BoxArrays boxes(random_boxes(count, count));
      View view = look_along({random.range(-50, 50), random.range(-50, 50), random.range(-50, 50)}, random.direction());
      if (count % 3 == 0) view.far = std::numeric_limits<double>::infinity();
      const Frustum frustum = view_frustum(view, 60);
      const auto reference = found(boxes, frustum, boxes_in_frustum_scalar);
      EXPECT_EQ(found(boxes, frustum, boxes_in_frustum), reference) << count << " on " << hwy::TargetName(target);
      inside += reference.size();
      all += count;
    }
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
  EXPECT_GT(inside, all / 50);  // the views do see some of the boxes and not all of them
  EXPECT_LT(inside, all / 2);
}

TEST(FrustumBoxes, RangesAndPlaneMasks) {
  Random random(4);
  const std::vector<Aabb> list = random_boxes(300, 9);
  const BoxArrays boxes(list);
  for (int round = 0; round < 200; ++round) {
    const View view = look_along({random.range(-50, 50), 0, random.range(-50, 50)}, random.direction());
    const Frustum frustum = view_frustum(view, 60);
    const std::uint32_t mask = random.below(64), begin = random.below(300), end = begin + random.below(301 - begin);
    std::vector<std::uint32_t> ids(end - begin + 64), expected;
    ids.resize(boxes_in_frustum(boxes, begin, end, frustum, mask, ids.data()));
    for (std::uint32_t i = begin; i < end; ++i) {
      bool in = !list[i].empty();
      for (int p = 0; p < frustum.count; ++p)
        if (((mask >> p) & 1u) != 0 && classify(frustum.planes[p], list[i]) == Containment::outside) in = false;
      if (in) expected.push_back(i);
    }
    EXPECT_EQ(ids, expected) << round;
  }
}

// An empty box beside planes along the axes: 0 * infinity, which must not swallow its neighbours in a vector.
TEST(FrustumBoxes, EmptyBoxesHideNoNeighboursFromPlanesAlongTheAxes) {
  std::vector<Aabb> list(150);
  for (std::size_t i = 0; i < list.size(); i += 3) list[i] = {glm::vec3(-1), glm::vec3(1)};
  const BoxArrays boxes(list);
  Frustum frustum;
  for (const glm::vec3 normal : {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1), glm::vec3(-1, 0, 0),
                                 glm::vec3(0, -1, 0), glm::vec3(0, 0, -1)})
    frustum.planes[static_cast<std::size_t>(frustum.count++)] = {normal, 5.0f};
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().DeInit();
    EXPECT_EQ(found(boxes, frustum, boxes_in_frustum).size(), 50u) << hwy::TargetName(target);
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
}

}  // namespace
}  // namespace sightline
