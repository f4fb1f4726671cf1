// Boxes in clip space: the definition by corners, and the batch against it.
#include "sightline/geometry/clip_boxes.hpp"

#include <gtest/gtest.h>

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

View random_view(Random& random, std::size_t i) {
  View view = look_along({random.range(-50, 50), random.range(-50, 50), random.range(-50, 50)}, random.direction());
  view.fov_y = random.range(0.2, 2.0);
  if (i % 3 == 0) view.far = std::numeric_limits<double>::infinity();
  if (i % 4 == 1) {
    view.projection = Projection::orthographic;
    view.far = 200;
  }
  return view;
}

TEST(ClipBoxes, CornersInTheUnitCube) {
  View view = look_along({0, 0, 0}, {0, 0, -1});
  const glm::dmat4 clip = view_projection(view);
  EXPECT_EQ(classify_in_clip_space({{-1, -1, -9}, {1, 1, -8}}, clip), Containment::inside);
  EXPECT_EQ(classify_in_clip_space({{-1, -1, -9}, {1, 1, 8}}, clip), Containment::intersecting);
  EXPECT_EQ(classify_in_clip_space({{-1, -1, 7}, {1, 1, 8}}, clip), Containment::outside);
  EXPECT_EQ(classify_in_clip_space({{-50, -0.1f, -6}, {50, 0.1f, -5}}, clip), Containment::intersecting);  // 20.11
  EXPECT_EQ(classify_in_clip_space({}, clip), Containment::outside);
}

TEST(ClipBoxes, BatchHoldsTheDefinitionAndIsAsTight) {
  Random random(1);
  std::size_t more = 0, all = 0;
  for (std::size_t i = 0; i < 60; ++i) {
    const std::vector<Aabb> boxes = random_boxes(200, i);
    const BoxArrays arrays(boxes);
    const glm::dmat4 clip = view_projection(random_view(random, i));
    std::vector<std::uint32_t> ids(boxes.size() + 64);
    ids.resize(boxes_in_clip_space(arrays, clip, 60, ids.data()));
    std::vector<bool> found(boxes.size());
    for (const std::uint32_t id : ids) found[id] = true;
    for (std::size_t b = 0; b < boxes.size(); ++b) {
      const bool in = classify_in_clip_space(boxes[b], clip) != Containment::outside;
      if (in) {
        EXPECT_TRUE(found[b]);
      }
      more += found[b] && !in ? 1 : 0;
      all += in ? 1 : 0;
    }
  }
  EXPECT_GT(all, 500u);
  EXPECT_LT(more, all / 50);
}

}  // namespace
}  // namespace sightline
