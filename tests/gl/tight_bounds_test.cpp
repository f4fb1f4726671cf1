// Tight bounds: they cover what the node covers, cost no more surface than allowed, and are never too many.
#include "gl/tight_bounds.hpp"

#include <gtest/gtest.h>

#include "sightline/scene/generate/generate.hpp"

namespace sightline::gl {
namespace {

class TightBoundsTest : public testing::Test {
 protected:
  TightBoundsTest()
      : scene_(generate_scene("city", {.objects = 600, .triangles = 0, .seed = 4})), bounds_(scene_.object_bounds()) {
    bvh_ = build_bvh(bounds_, {.max_leaf_size = 1});
  }
  Scene scene_;
  std::vector<Aabb> bounds_;
  Bvh bvh_;
};

TEST_F(TightBoundsTest, EveryObjectLiesInABoxOfEachNodeAboveIt) {
  for (const double sigma : {0.0, 1.0, 1.4, 3.0}) {
    TightBounds tight;
    tight.build(bvh_, {sigma, 3});
    for (std::uint32_t n = 0; n < bvh_.nodes.size(); ++n) {
      const ItemRange range = items_below(bvh_, n);
      for (std::uint32_t i = range.begin; i < range.end; ++i) {
        bool inside = false;
        for (const Aabb& box : tight.boxes(n)) inside = inside || box.contains(bounds_[bvh_.items[i]]);
        ASSERT_TRUE(inside) << "node " << n << ", object " << bvh_.items[i] << ", sigma " << sigma;
      }
    }
  }
}

TEST_F(TightBoundsTest, SurfaceAndNumberStayWithinTheirLimits) {
  for (const double sigma : {1.0, 1.4, 2.0})
    for (const int depth : {0, 1, 3}) {
      TightBounds tight;
      tight.build(bvh_, {sigma, depth});
      for (std::uint32_t n = 0; n < bvh_.nodes.size(); ++n) {
        float sum = 0.0f;
        for (const Aabb& box : tight.boxes(n)) sum += box.half_area();
        EXPECT_LE(tight.boxes(n).size(), std::size_t{1} << depth);
        EXPECT_GE(tight.boxes(n).size(), 1u);
        EXPECT_LE(sum, static_cast<float>(sigma) * bvh_.nodes[n].bounds.half_area() * 1.0001f);
      }
    }
}

TEST_F(TightBoundsTest, ALargerSigmaGivesMoreBoxes) {
  std::size_t last = 0;
  for (const double sigma : {0.5, 1.2, 1.4, 1.8, 2.5}) {
    TightBounds tight;
    tight.build(bvh_, {sigma, 3});
    EXPECT_GE(tight.box_count(), last);
    last = tight.box_count();
  }
  EXPECT_GT(last, bvh_.nodes.size());
}

}  // namespace
}  // namespace sightline::gl
