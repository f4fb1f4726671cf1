// Where depth buffers can no longer tell planes apart, predicted and drawn (checklist 1.21, 3.15-3.17).
#include "sightline/raster/depth_precision.hpp"

#include <gtest/gtest.h>

namespace sightline::raster {
namespace {

// 3.15-3.17: two planes are drawn farther and farther away until the nearer one is lost at half of the pixels: there
// the slope of the depth is half a step per gap, sqrt(2) farther than one step per gap.
TEST(DepthPrecision, PlanesFightWhereTheSlopeOfDepthSays) {
  const double near = 0.1, far = 1000.0, apart = 0.05;
  for (const DepthFormat format :
       {DepthFormat::unorm16, DepthFormat::unorm20, DepthFormat::unorm24, DepthFormat::float32}) {
    const double predicted = fighting_distance(format, apart, near, far);
    EXPECT_NEAR(depth_step_at(format, predicted, near, far), apart, 1e-9);
    double half = 0;
    for (double d = near * 2; d < far && half == 0; d *= 1.01)
      if (fighting_share(format, d, apart, near, far) >= 0.5) half = d;
    ASSERT_GT(half, 0.0);
    const double ratio = half / (predicted * std::sqrt(2.0));
    EXPECT_LE(ratio, 1.04) << depth_bits(format);
    // Window depths of corners are floats: 2^-24 is their rounding and with these formats a whole step, so that a gap
    // of one step and a half may look like half a step.
    const bool fine = format == DepthFormat::unorm24 || format == DepthFormat::float32;
    EXPECT_GE(ratio, fine ? std::sqrt(0.5 / 1.5) : 0.96) << depth_bits(format);
    EXPECT_EQ(fighting_share(format, 0.5 * predicted, apart, near, far), 0.0) << depth_bits(format);
    EXPECT_GT(fighting_share(format, 4 * predicted, apart, near, far), 0.8) << depth_bits(format);
  }
}

// 1.21: what is just noticeable. Eyes and depth buffers both lose with the square of the distance; occlusion, of which
// eyes need but an edge, stays the same share of it, and from a few metres on it tells more than two eyes.
TEST(DepthPrecision, JustNoticeableDepths) {
  for (const double d : {1.0, 7.0, 40.0}) {
    EXPECT_NEAR(stereo_threshold(2 * d) / stereo_threshold(d), 4.0, 1e-12);
    EXPECT_NEAR(
        depth_step_at(DepthFormat::unorm24, 2 * d, 0.1, 1000) / depth_step_at(DepthFormat::unorm24, d, 0.1, 1000), 4.0,
        1e-9);
  }
  EXPECT_LT(stereo_threshold(0.5), occlusion_threshold * 0.5);
  EXPECT_GT(stereo_threshold(5.0), occlusion_threshold * 5.0);
  EXPECT_LT(stereo_threshold(10.0), relative_size_threshold * 10.0);
  EXPECT_GT(stereo_threshold(50.0), relative_size_threshold * 50.0);
  // A buffer of 24 bits is finer than eyes, one of 16 bits is not (near plane at 10 cm).
  EXPECT_LT(depth_step_at(DepthFormat::unorm24, 10, 0.1, 1000), stereo_threshold(10));
  EXPECT_GT(depth_step_at(DepthFormat::unorm16, 10, 0.1, 1000), 0.01 * stereo_threshold(10));
}

}  // namespace
}  // namespace sightline::raster
