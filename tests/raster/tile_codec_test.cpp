// Depth tiles: lossless for every SIMD target, and small where surfaces are flat (checklist 5.09, 5.14 with E7).
#include "sightline/raster/tile_codec.hpp"

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "sightline/scene/generate/random.hpp"

namespace sightline::raster {
namespace {

DepthTile random_tile(Random& random, int kind) {
  DepthTile tile;
  const double z = random.range(0, 1 << 24), dx = random.range(-3000, 3000), dy = random.range(-3000, 3000);
  const double z2 = random.range(0, 1 << 24);
  const double bend = random.range(-40, 40);
  std::array<double, 64> twisted{};  // noise in the mixed differences
  for (std::size_t i = 0; i < 64; ++i)
    twisted[i] = (i == 0       ? z
                  : i < 8      ? dx
                  : i % 8 == 0 ? dy
                               : bend) +
                 random.range(-20, 20) + (i % 8 > 0 ? twisted[i - 1] : 0) + (i >= 8 ? twisted[i - 8] : 0) -
                 (i >= 8 && i % 8 > 0 ? twisted[i - 9] : 0);
  for (std::size_t i = 0; i < 64; ++i) {
    const double x = static_cast<double>(i % 8), y = static_cast<double>(i / 8);
    double v = z + dx * x + dy * y;
    if (kind == 1) v += bend * y * y + 3 * bend * x * y + (dx > 0 ? 9 * bend * x * x : 0);
    if (kind == 2 && x + y > 8) v = z2;
    if (kind == 3) v = random.range(0, 1 << 24);
    if (kind == 4) v = random.below(2) == 0 ? 0 : 0xFFFFFF;
    if (kind == 5) v += random.range(-60, 60);
    if (kind == 6) v = twisted[i];
    if (kind == 7) v += 9 * bend * y * y;
    tile[i] = static_cast<std::uint32_t>(std::clamp(v, 0.0, 16777215.0));
  }
  return tile;
}

// 5.14: lossless, whatever the tile, with the scalar decoder and that of every SIMD target.
TEST(TileCodec, IsLossless) {
  Random random(8);
  std::size_t modes[tile_modes] = {};
  std::vector<DepthTile> tiles;
  std::vector<PackedTile> packed;
  for (int round = 0; round < 20000; ++round) {
    tiles.push_back(random_tile(random, round % 8));
    packed.push_back(encode_tile(tiles.back()));
    ++modes[static_cast<std::size_t>(packed.back().mode)];
    ASSERT_LE(packed.back().size, raw_tile_bytes);
    // What the size does not count must not matter.
    std::fill(packed.back().bytes.begin() + packed.back().size, packed.back().bytes.end(), std::uint8_t{0xA5});
    DepthTile scalar{};
    decode_tile_scalar(packed.back(), scalar);
    ASSERT_EQ(scalar, tiles.back()) << round;
  }
  for (std::size_t mode = 0; mode < tile_modes; ++mode) EXPECT_GT(modes[mode], 100u) << mode;  // each is met
  hwy::SetSupportedTargetsForTest(0);
  for (auto targets = static_cast<std::int64_t>(hwy::SupportedTargets()); targets != 0; targets &= targets - 1) {
    hwy::SetSupportedTargetsForTest(targets & -targets);
    std::vector<DepthTile> together(tiles.size());
    decode_tiles(packed.data(), packed.size(), together.data());
    for (std::size_t i = 0; i < tiles.size(); ++i) {
      DepthTile tile{};
      decode_tile(packed[i], tile);
      ASSERT_EQ(tile, tiles[i]) << i << " " << hwy::TargetName(targets & -targets);
      ASSERT_EQ(together[i], tiles[i]) << i << " " << hwy::TargetName(targets & -targets);
    }
  }
  hwy::SetSupportedTargetsForTest(0);
  DepthTile flat;
  flat.fill(0xABCDEF);
  EXPECT_LE(encode_tile(flat).size * 13, raw_tile_bytes);
  EXPECT_EQ(dpcm_first_order_bytes(flat), 4u);
}

// A flat surface leaves nothing but its plane, whatever its slopes and where its roundings fall; a crease or a
// silhouette between two flat ones little more than two planes and their mask.
TEST(TileCodec, FlatSurfacesLeaveOnlyTheirPlanes) {
  Random random(21);
  std::size_t one = 0, two = 0;
  constexpr int rounds = 500;
  for (int round = 0; round < rounds; ++round) {
    const auto plane = [&] {
      return std::array{random.range(4e6, 12e6), random.range(-20000, 20000), random.range(-20000, 20000)};
    };
    const auto a = plane(), b = plane();
    const double cut = random.range(3, 11), turn = random.range(-1, 1);
    DepthTile flat, creased;
    for (std::size_t i = 0; i < 64; ++i) {
      const double x = static_cast<double>(i % 8), y = static_cast<double>(i / 8);
      const auto at = [&](const auto& p) {
        return static_cast<std::uint32_t>(std::lround(p[0] + p[1] * x + p[2] * y));
      };
      flat[i] = at(a);
      creased[i] = x + turn * y + y < cut ? at(a) : at(b);
    }
    one += encode_tile(flat).size;
    two += encode_tile(creased).size;
  }
  EXPECT_LT(one, 15u * rounds);
  EXPECT_LT(two, 38u * rounds);
}

}  // namespace
}  // namespace sightline::raster
