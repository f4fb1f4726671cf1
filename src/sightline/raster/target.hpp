// What is drawn into: colour (RGBA8), depth in one of four formats, stencil (8 bits), and what is counted per pixel.
// Window depth as in OpenGL: 0 at the near, 1 at the far plane. Row 0 is the top row. Checklist 3.02, 3.15, 8.01.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sightline/raster/state.hpp"

namespace sightline::raster {

enum class DepthFormat : std::uint8_t { float32, unorm24, unorm20, unorm16 };

/// Window depth (clamped to [0, 1]) to what the buffer stores, and back. Codes compare as unsigned numbers in the order
/// of the depths: the bits of a float, or round(z * (2^n - 1)).
std::uint32_t depth_code(DepthFormat format, double z);
double depth_value(DepthFormat format, std::uint32_t code);
/// Number of bits of a fixed-point format, 0 for float32.
int depth_bits(DepthFormat format);

/// 0xAABBGGRR (bytes r, g, b, a) from and to components in [0, 1], rounded to nearest.
std::uint32_t pack_colour(const glm::vec4& colour);
glm::vec4 unpack_colour(std::uint32_t colour);

/// Counts per pixel; each is a definition of depth complexity or overdraw of its own (E9).
struct PixelCounts {
  std::vector<std::uint32_t> fragments;      // covered by a triangle that was not culled: layers
  std::vector<std::uint32_t> depth_tests;    // z-tests
  std::vector<std::uint32_t> depth_writes;   // z-writes
  std::vector<std::uint32_t> colour_writes;  // overdraw
  void resize(std::size_t pixels);
};

class Target {
 public:
  Target(int width, int height, DepthFormat format = DepthFormat::float32);

  int width = 0, height = 0;
  DepthFormat format = DepthFormat::float32;
  std::vector<std::uint32_t> colour;  // packed
  std::vector<std::uint32_t> depth;   // codes
  std::vector<std::uint8_t> stencil;
  PixelCounts counts;  // empty: not counted

  /// glClear of each: within the scissor, under the colour, depth and stencil masks, ignoring the stencil test (E15).
  void clear_colour(const State& state, const glm::vec4& value);
  void clear_depth(const State& state, double z = 1.0);
  void clear_stencil(const State& state, std::uint8_t value = 0);
  /// All three without scissor and masks: black without opacity, farthest, 0.
  void clear();

  void count_pixels() { counts.resize(colour.size()); }
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
  [[nodiscard]] double depth_at(int x, int y) const { return depth_value(format, depth[index(x, y)]); }
};

}  // namespace sightline::raster
