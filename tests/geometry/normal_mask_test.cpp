// Normal masks: classes of the direction cube, and masks that hold for every normal of a class and every direction of a
// view (checklist 18.02-18.09).
#include "sightline/geometry/normal_mask.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <bit>

#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/view.hpp"

namespace sightline {
namespace {

TEST(NormalMask, ClassesOfTheDirectionCube) {
  EXPECT_EQ(DirectionCube(16).classes(), 1536);  // 18.03
  EXPECT_EQ(DirectionCube(6).classes(), 216);
  EXPECT_LE(DirectionCube(18).classes(), 2048);  // 18.04
  for (const int n : {1, 2, 6, 16, 18}) {
    const DirectionCube cube(n);
    std::vector<int> hit(static_cast<std::size_t>(cube.classes()));
    Random random(1);
    for (int i = 0; i < 200 * cube.classes(); ++i) {
      const int c = cube.class_of(random.direction() * random.range(0.1, 9));
      ASSERT_GE(c, 0);
      ASSERT_LT(c, cube.classes());
      ++hit[static_cast<std::size_t>(c)];
    }
    for (const int count : hit) EXPECT_GT(count, 0);
  }
  for (const glm::dvec3 axis :
       {glm::dvec3(1, 0, 0), glm::dvec3(0, -1, 0), glm::dvec3(0, 0, 1), glm::dvec3(1, 1, 1), glm::dvec3(-1, -1, -1)})
    EXPECT_LT(DirectionCube(16).class_of(axis), 1536);
}

TEST(NormalMask, TwoBytesAPolygon) {
  EXPECT_EQ(sizeof(PolygonNormalMask), 2u);
  for (int c = 0; c < 2048; ++c) {
    const PolygonNormalMask bits = polygon_normal_mask(c);
    EXPECT_EQ(bits.byte_offset * 8 + std::countr_zero(bits.bit_mask), c);
    EXPECT_EQ(std::popcount(bits.bit_mask), 1);
  }
}

std::vector<glm::vec3> corner_directions(const View& view, int sectors) {
  std::vector<glm::vec3> directions;
  for (int row = 0; row <= sectors; ++row)
    for (int column = 0; column <= sectors; ++column)
      directions.emplace_back(glm::normalize(pixel_ray(view, static_cast<double>(view.width) * column / sectors,
                                                       static_cast<double>(view.height) * row / sectors)
                                                 .direction));
  return directions;
}

/// The masks of all sectors.
std::vector<BackMask> masks_of(const DirectionCube& cube, const View& view, int sectors) {
  const auto directions = corner_directions(view, sectors);
  const auto across = static_cast<std::size_t>(sectors) + 1;
  std::vector<BackMask> masks;
  for (std::size_t row = 0; row + 1 < across; ++row)
    for (std::size_t column = 0; column + 1 < across; ++column) {
      const std::size_t at = row * across + column;
      masks.push_back(back_mask(
          cube, std::vector{directions[at], directions[at + 1], directions[at + across], directions[at + across + 1]},
          4e-6f));
    }
  return masks;
}

/// For every direction within a sector a culled class has no normal that could face it: tried by random normals and
/// directions. And the masks are of use: sectors find more than the whole image.
TEST(NormalMask, CulledClassesTurnTheirBacksEverywhereInTheSector) {
  Random random(2);
  for (const int n : {1, 6, 16, 18})
    for (const int sectors : {1, 2, 5}) {
      const DirectionCube cube(n);
      View view = look_along({0, 0, 0}, random.direction());
      view.fov_y = random.range(0.3, 1.6);
      const std::vector<BackMask> masks = masks_of(cube, view, sectors);
      for (int i = 0; i < 40000; ++i) {
        const double x = random.range(0, view.width), y = random.range(0, view.height);
        const int sx = static_cast<int>(x * sectors / view.width), sy = static_cast<int>(y * sectors / view.height);
        const glm::dvec3 v = pixel_ray(view, x, y).direction, normal = random.direction();
        const PolygonNormalMask bits = polygon_normal_mask(cube.class_of(normal));
        const BackMask& mask = masks[static_cast<std::size_t>(sy * sectors + sx)];
        if ((mask[bits.byte_offset] & bits.bit_mask) != 0) {
          EXPECT_GT(glm::dot(normal, v), 0.0) << n << " " << sectors;
        }
      }
    }
}

TEST(NormalMask, SmallerSectorsFindMore) {
  const DirectionCube cube(16);
  const View view = look_along({0, 0, 0}, {1, 0.2, -0.4});
  const auto found = [&](int sectors) {
    const std::vector<BackMask> masks = masks_of(cube, view, sectors);
    double classes = 0;
    for (const BackMask& mask : masks)
      for (const std::uint8_t byte : mask) classes += std::popcount(byte);
    return classes / (sectors * sectors * cube.classes());
  };
  EXPECT_GT(found(1), 0.1);
  EXPECT_GT(found(2), found(1));
  EXPECT_GT(found(8), found(2));
  EXPECT_LT(found(16), 0.5);
  const std::vector<glm::vec3> direction{glm::normalize(glm::vec3(1, 0.2f, -0.4f))};
  const BackMask one = back_mask(cube, direction, 4e-6f);  // orthographic (18.05): almost half of all
  double classes = 0;
  for (const std::uint8_t byte : one) classes += std::popcount(byte);
  EXPECT_GT(classes / cube.classes(), 0.44);
  EXPECT_LT(classes / cube.classes(), 0.5);
}

/// 18.07: a class is set exactly if all 16 products of its corner normals with the corner directions reach the margin.
TEST(NormalMask, SixteenProductsDecideOnEveryTarget) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().DeInit();
    for (int n = 1; n <= 18; ++n) {
      const DirectionCube cube(n);
      const auto& [x, y, z] = cube.corners();
      const auto directions = corner_directions(look_along({0, 0, 0}, {0.3, -0.2, 0.9}), 1);
      const BackMask mask = back_mask(cube, directions, 4e-6f);
      int set = 0;
      for (int c = 0; c < cube.classes(); ++c) {
        const int face = c / (n * n), row = c / n % n, column = c % n;
        double least = 2.0;
        for (const int corner : {0, 1, n + 1, n + 2}) {
          const auto i = static_cast<std::size_t>((face * (n + 1) + row) * (n + 1) + column + corner);
          for (const glm::vec3& v : directions)
            least = std::min(least, glm::dot(glm::dvec3(v), glm::dvec3(x[i], y[i], z[i])));
        }
        const PolygonNormalMask bits = polygon_normal_mask(c);
        const bool back = (mask[bits.byte_offset] & bits.bit_mask) != 0;
        set += back ? 1 : 0;
        if (std::abs(least - 4e-6) > 1e-6) {
          EXPECT_EQ(back, least >= 4e-6) << n << " " << c << " on " << hwy::TargetName(target);
        }
      }
      int all = 0;
      for (const std::uint8_t byte : mask) all += std::popcount(byte);
      EXPECT_EQ(all, set);  // no bit beyond the classes
    }
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
}

TEST(NormalMask, EveryTargetAndTailGivesTheReferencesAnswer) {
  Random random(5);
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().DeInit();
    for (std::size_t count = 1; count < 200; ++count) {
      const std::size_t padded = (count + 63) / 64 * 64;
      std::vector<std::uint8_t> offsets(padded), bits(padded);
      BackMask mask{};
      for (std::uint8_t& byte : mask) byte = static_cast<std::uint8_t>(count % 3 == 0 ? random.below(256) : 0);
      for (std::size_t i = count % 256; i < 256; i += 7) mask[i] = static_cast<std::uint8_t>(random.below(256));
      for (std::size_t i = 0; i < count; ++i) {
        offsets[i] = static_cast<std::uint8_t>(random.below(256));
        bits[i] = static_cast<std::uint8_t>(i % 11 == 3 ? 0 : 1u << random.below(8));
      }
      std::vector<std::uint64_t> a(padded / 64, 7), b(a.size(), 9);
      front_by_mask(offsets.data(), bits.data(), count, mask, a.data());
      front_by_mask_scalar(offsets.data(), bits.data(), count, mask, b.data());
      EXPECT_EQ(a, b) << count << " on " << hwy::TargetName(target);
    }
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
}

}  // namespace
}  // namespace sightline
