// The image pyramids of the occlusion cullers, each against brute force over its pixels: z-pyramid (Greene 1993),
// overlap pyramid (Zhang 1997), occupancy map (Staneker 2003). Odd sizes, every rectangle.
#include <gtest/gtest.h>

#include <cmath>

#include "sightline/raster/box_footprint.hpp"
#include "sightline/raster/occupancy_map.hpp"
#include "sightline/raster/overlap_pyramid.hpp"
#include "sightline/raster/z_pyramid.hpp"
#include "sightline/scene/generate/random.hpp"

namespace sightline {
namespace {

constexpr int sizes[][2] = {{1, 1}, {2, 3}, {7, 5}, {16, 16}, {33, 9}, {1, 20}};

TEST(ZPyramid, EveryLevelHoldsTheFarthestOfItsBlock) {
  for (const auto& size : sizes)
    for (const int fan : {2, 3, 4}) {
      Random random(5);
      ZPyramid pyramid;
      pyramid.reset(size[0], size[1], fan);
      EXPECT_TRUE(std::isinf(pyramid.at(pyramid.level_count() - 1, 0, 0)));
      for (int y = 0; y < size[1]; ++y)
        for (int x = 0; x < size[0]; ++x) pyramid.pixel(x, y) = static_cast<float>(random.range(1, 100));
      pyramid.refresh(0, 0, size[0], size[1]);
      int block = 1;
      for (int level = 0; level < pyramid.level_count(); ++level, block *= fan)
        for (int y = 0; y < pyramid.level_height(level); ++y)
          for (int x = 0; x < pyramid.level_width(level); ++x) {
            float farthest = 0;
            for (int j = y * block; j < std::min((y + 1) * block, size[1]); ++j)
              for (int i = x * block; i < std::min((x + 1) * block, size[0]); ++i)
                farthest = std::max(farthest, pyramid.pixel(i, j));
            EXPECT_EQ(pyramid.at(level, x, y), farthest) << level << " " << x << " " << y;
          }
      EXPECT_EQ(pyramid.level_width(pyramid.level_count() - 1), 1);
    }
}

TEST(ZPyramid, CountsOpenPixelsAsBruteForceDoes) {
  for (const auto& size : sizes)
    for (const int fan : {2, 4}) {
      Random random(9);
      ZPyramid pyramid;
      pyramid.reset(size[0], size[1], fan);
      for (int y = 0; y < size[1]; ++y)
        for (int x = 0; x < size[0]; ++x) pyramid.pixel(x, y) = static_cast<float>(1 + random.below(4));
      pyramid.refresh(0, 0, size[0], size[1]);
      for (int y0 = 0; y0 < size[1]; ++y0)
        for (int x0 = 0; x0 < size[0]; ++x0)
          for (int y1 = y0 + 1; y1 <= size[1]; y1 += 2)
            for (int x1 = x0 + 1; x1 <= size[0]; x1 += 3)
              for (const double nearest : {0.5, 2.5, 4.5}) {
                int open = 0;
                for (int y = y0; y < y1; ++y)
                  for (int x = x0; x < x1; ++x) open += static_cast<double>(pyramid.pixel(x, y)) > nearest ? 1 : 0;
                std::uint64_t cells = 0;
                EXPECT_EQ(pyramid.open_pixels(x0, y0, x1, y1, nearest, 1 << 30, cells), open);
                const int stopped = pyramid.open_pixels(x0, y0, x1, y1, nearest, 2, cells);
                EXPECT_EQ(stopped > 2, open > 2);
              }
    }
}

// One look at a coarse cell answers for a whole block (the point of the pyramid).
TEST(ZPyramid, AnswersCoarseToFine) {
  ZPyramid pyramid;
  pyramid.reset(64, 64);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) pyramid.pixel(x, y) = 5;
  pyramid.refresh(0, 0, 64, 64);
  std::uint64_t cells = 0;
  EXPECT_EQ(pyramid.open_pixels(0, 0, 64, 64, 6, 0, cells), 0);
  EXPECT_LE(cells, 4u);
  pyramid.pixel(40, 3) = 7;
  pyramid.refresh(40, 3, 41, 4);
  EXPECT_EQ(pyramid.open_pixels(0, 0, 64, 64, 6, 0, cells), 1);
  EXPECT_EQ(pyramid.open_pixels(0, 0, 40, 64, 6, 0, cells), 0);
}

TEST(ZPyramid, EqualDepthIsNotBehind) {
  EXPECT_FALSE(behind(5.0, 5.0f));
  EXPECT_TRUE(behind(5.001, 5.0f));
  EXPECT_FALSE(behind(-5.0, -5.0f));
  EXPECT_TRUE(behind(-4.99, -5.0f));
  EXPECT_FALSE(behind(1e30, INFINITY));
}

// Zhang 1997: the opacity of a cell is the mean of its pixels; the threshold 1 - holes / n lets small holes pass.
TEST(OverlapPyramid, OpacityIsTheCoveredShare) {
  for (const auto& size : sizes) {
    Random random(3);
    OverlapPyramid pyramid;
    pyramid.reset(size[0], size[1]);
    std::vector<int> covered(static_cast<std::size_t>(size[0] * size[1]));
    for (int y = 0; y < size[1]; ++y)
      for (int x = 0; x < size[0]; ++x)
        if (random.below(4) != 0) {
          pyramid.cover(x, y);
          covered[static_cast<std::size_t>(y * size[0] + x)] = 1;
        }
    pyramid.build();
    for (int level = 0; level < pyramid.level_count(); ++level)
      for (int y = 0; y < pyramid.level_height(level); ++y)
        for (int x = 0; x < pyramid.level_width(level); ++x) {
          double sum = 0, pixels = 0;
          for (int j = y << level; j < std::min((y + 1) << level, size[1]); ++j)
            for (int i = x << level; i < std::min((x + 1) << level, size[0]); ++i, ++pixels)
              sum += covered[static_cast<std::size_t>(j * size[0] + i)];
          EXPECT_DOUBLE_EQ(pyramid.opacity(level, x, y), sum / pixels);
        }
    for (int y0 = 0; y0 < size[1]; ++y0)
      for (int x0 = 0; x0 < size[0]; ++x0)
        for (int y1 = y0 + 1; y1 <= size[1]; ++y1)
          for (int x1 = x0 + 1; x1 <= size[0]; ++x1) {
            bool all = true;
            for (int y = y0; y < y1; ++y)
              for (int x = x0; x < x1; ++x) all = all && covered[static_cast<std::size_t>(y * size[0] + x)] != 0;
            std::uint64_t cells = 0;
            EXPECT_EQ(pyramid.covers(x0, y0, x1, y1, {}, cells), all);
          }
  }
}

TEST(OverlapPyramid, SmallHolesPassAThresholdBelowOne) {
  OverlapPyramid pyramid;
  pyramid.reset(16, 16);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x)
      if (x != 5 || y != 6) pyramid.cover(x, y);
  pyramid.build();
  std::uint64_t cells = 0;
  EXPECT_FALSE(pyramid.covers(0, 0, 16, 16, {}, cells));
  EXPECT_TRUE(pyramid.covers(0, 0, 16, 16, {.opacity = 1.0, .holes = 1}, cells));
  EXPECT_TRUE(pyramid.covers(0, 0, 16, 16, {.opacity = 63.0 / 64, .holes = 0}, cells));
  EXPECT_FALSE(pyramid.covers(0, 0, 16, 16, {.opacity = 63.5 / 64, .holes = 0}, cells));
  EXPECT_FALSE(pyramid.covers(5, 6, 6, 7, {.opacity = 1.0, .holes = 1}, cells)) << "a lone open pixel is no small hole";
}

TEST(OccupancyMap, CoversWhatIsOccupiedWhollyAndNothingElse) {
  for (const auto& size : sizes) {
    Random random(3);
    OccupancyMap map;
    map.reset(size[0], size[1]);
    std::vector<int> set(static_cast<std::size_t>(size[0] * size[1]));
    std::uint64_t cells = 0;
    EXPECT_FALSE(map.covers(0, 0, size[0], size[1], cells));
    for (int k = 0; k < size[0] * size[1]; ++k) {
      const int x = static_cast<int>(random.below(static_cast<std::uint32_t>(size[0])));
      const int y = static_cast<int>(random.below(static_cast<std::uint32_t>(size[1])));
      map.occupy(x, y);  // often again
      set[static_cast<std::size_t>(y * size[0] + x)] = 1;
    }
    for (int round = 0; round < 2; ++round) {
      for (int y0 = 0; y0 < size[1]; ++y0)
        for (int x0 = 0; x0 < size[0]; ++x0)
          for (int y1 = y0 + 1; y1 <= size[1]; ++y1)
            for (int x1 = x0 + 1; x1 <= size[0]; ++x1) {
              bool all = true;
              for (int y = y0; y < y1; ++y)
                for (int x = x0; x < x1; ++x) all = all && set[static_cast<std::size_t>(y * size[0] + x)] != 0;
              EXPECT_EQ(map.covers(x0, y0, x1, y1, cells), all);
            }
      for (int y = 0; y < size[1]; ++y)
        for (int x = 0; x < size[0]; ++x) {
          map.occupy(x, y);
          set[static_cast<std::size_t>(y * size[0] + x)] = 1;
        }
    }
    EXPECT_TRUE(map.full(map.level_count() - 1, 0, 0));
  }
}

TEST(BoxFootprint, HoldsTheProjectionOfTheBox) {
  Random random(8);
  for (int i = 0; i < 300; ++i) {
    View view = look_along({0, 0, 0}, random.direction());
    view.width = 1 + static_cast<int>(random.below(300));
    view.height = 1 + static_cast<int>(random.below(200));
    if (i % 3 == 0) {
      view.projection = Projection::orthographic;
      view.span_y = random.range(1, 20);
    }
    const int width = 1 + static_cast<int>(random.below(200)), height = 1 + static_cast<int>(random.below(200));
    const glm::vec3 centre = glm::vec3(10.0 * random.direction()), half(random.range(0.01, 4), 0.5, 0.2);
    const Aabb box{centre - half, centre + half};
    const BoxFootprint f = BoxProjector(view, width, height).project(box);
    for (int k = 0; k < 200; ++k) {
      const glm::dvec3 p(random.range(box.lo.x, box.hi.x), random.range(box.lo.y, box.hi.y),
                         random.range(box.lo.z, box.hi.z));
      const glm::dvec4 clip = view_projection(view) * glm::dvec4(p, 1.0);
      const double distance = glm::dot(view_direction(view), p - view.eye);
      if (distance < view.near) continue;
      const double x = (0.5 + 0.5 * clip.x / clip.w) * width, y = (0.5 - 0.5 * clip.y / clip.w) * height;
      if (x < 0 || y < 0 || x >= width || y >= height) continue;
      ASSERT_NE(f.place, BoxPlace::unseen);
      EXPECT_TRUE(x >= f.x0 && x <= f.x1 && y >= f.y0 && y <= f.y1);
      EXPECT_GE(distance, f.nearest - 1e-5);
      EXPECT_LE(distance, f.farthest + 1e-5);
    }
  }
}

}  // namespace
}  // namespace sightline
