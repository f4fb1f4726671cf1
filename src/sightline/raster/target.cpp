#include "sightline/raster/target.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace sightline::raster {
namespace {

/// Calls f(index) for the pixels that a clear reaches.
template <class F>
void each_in_scissor(const Target& target, const Scissor& scissor, F&& f) {
  int x0 = 0, y0 = 0, x1 = target.width, y1 = target.height;
  if (scissor.enabled) {
    x0 = std::clamp(scissor.x, 0, x1);
    y0 = std::clamp(scissor.y, 0, y1);
    x1 = std::clamp(scissor.x + scissor.width, x0, x1);
    y1 = std::clamp(scissor.y + scissor.height, y0, y1);
  }
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) f(target.index(x, y));
}

}  // namespace

int depth_bits(DepthFormat format) {
  switch (format) {
    case DepthFormat::float32:
      return 0;
    case DepthFormat::unorm24:
      return 24;
    case DepthFormat::unorm20:
      return 20;
    case DepthFormat::unorm16:
      return 16;
  }
  return 0;
}

std::uint32_t depth_code(DepthFormat format, double z) {
  const double clamped = z > 0.0 ? std::min(z, 1.0) : 0.0;  // not a number counts as 0
  if (format == DepthFormat::float32) return std::bit_cast<std::uint32_t>(static_cast<float>(clamped));
  const double largest = static_cast<double>((1u << depth_bits(format)) - 1u);
  return static_cast<std::uint32_t>(clamped * largest + 0.5);
}

double depth_value(DepthFormat format, std::uint32_t code) {
  if (format == DepthFormat::float32) return static_cast<double>(std::bit_cast<float>(code));
  return static_cast<double>(code) / static_cast<double>((1u << depth_bits(format)) - 1u);
}

std::uint32_t pack_colour(const glm::vec4& colour) {
  std::uint32_t packed = 0;
  for (int i = 0; i < 4; ++i)
    packed |= static_cast<std::uint32_t>(std::clamp(colour[i], 0.0f, 1.0f) * 255.0f + 0.5f) << (8 * i);
  return packed;
}

glm::vec4 unpack_colour(std::uint32_t colour) {
  glm::vec4 result;
  for (int i = 0; i < 4; ++i) result[i] = static_cast<float>((colour >> (8 * i)) & 0xFF) / 255.0f;
  return result;
}

void PixelCounts::resize(std::size_t pixels) {
  for (auto* plane : {&fragments, &depth_tests, &depth_writes, &colour_writes}) plane->assign(pixels, 0);
}

Target::Target(int w, int h, DepthFormat f) : width(w), height(h), format(f) {
  const auto pixels = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
  colour.resize(pixels);
  depth.resize(pixels);
  stencil.resize(pixels);
  clear();
}

void Target::clear() {
  std::fill(colour.begin(), colour.end(), 0u);
  std::fill(depth.begin(), depth.end(), depth_code(format, 1.0));
  std::fill(stencil.begin(), stencil.end(), std::uint8_t{0});
}

void Target::clear_colour(const State& state, const glm::vec4& value) {
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < 4; ++i) mask |= state.color_mask[i] ? 0xFFu << (8 * i) : 0u;
  const std::uint32_t packed = pack_colour(value) & mask;
  each_in_scissor(*this, state.scissor, [&](std::size_t i) { colour[i] = (colour[i] & ~mask) | packed; });
}

void Target::clear_depth(const State& state, double z) {
  if (!state.depth.mask) return;
  const std::uint32_t code = depth_code(format, z);
  each_in_scissor(*this, state.scissor, [&](std::size_t i) { depth[i] = code; });
}

void Target::clear_stencil(const State& state, std::uint8_t value) {
  const std::uint8_t mask = state.stencil.front.write_mask;  // glClear looks at the front mask
  each_in_scissor(*this, state.scissor, [&](std::size_t i) {
    stencil[i] = static_cast<std::uint8_t>((stencil[i] & ~mask) | (value & mask));
  });
}

}  // namespace sightline::raster
