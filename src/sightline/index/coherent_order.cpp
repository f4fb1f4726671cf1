#include "sightline/index/coherent_order.hpp"

#include <array>
#include <cstdint>
#include <utility>

#include "sightline/index/bvh8.hpp"

namespace sightline {
namespace {

constexpr int bits = 5, digits = 3;
constexpr std::size_t radix = 1u << (6 * bits / digits);

/// Bit i of five goes to bit 6 i.
constexpr std::array<std::uint32_t, 32> spread = [] {
  std::array<std::uint32_t, 32> table{};
  for (std::uint32_t v = 0; v < 32; ++v)
    for (std::uint32_t i = 0; i < 5; ++i) table[v] |= ((v >> i) & 1u) << (6 * i);
  return table;
}();

}  // namespace

std::vector<std::uint32_t> coherent_order(const Aabb& bounds, std::span<const Segment> segments) {
  using Key = std::pair<std::uint32_t, std::uint32_t>;  // code, segment
  const glm::vec3 extent = glm::max(bounds.empty() ? glm::vec3(0.0f) : bounds.extent(), 1e-30f);
  const glm::vec3 scale = 32.0f / extent;
  std::vector<Key> keys(segments.size()), other(segments.size());
  std::array<std::array<std::uint32_t, radix>, digits> counts{};
  for (std::uint32_t i = 0; i < keys.size(); ++i) {
    std::uint32_t code = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float a = (segments[i].a[axis] - bounds.lo[axis]) * scale[axis];
      const float b = (segments[i].b[axis] - bounds.lo[axis]) * scale[axis];
      // Comparisons that a NaN fails.
      const auto cell = [](float p) { return p > 0.0f ? (p < 31.0f ? static_cast<std::uint32_t>(p) : 31u) : 0u; };
      code |= spread[cell(a)] << (2 * axis + 1) | spread[cell(b)] << (2 * axis);
    }
    keys[i] = {code, i};
    for (std::size_t d = 0; d < digits; ++d) ++counts[d][(code >> (10 * d)) & (radix - 1)];
  }
  for (std::size_t d = 0; d < digits; ++d) {
    std::uint32_t sum = 0;
    for (std::uint32_t& c : counts[d]) sum += std::exchange(c, sum);
    for (const Key& key : keys) other[counts[d][(key.first >> (10 * d)) & (radix - 1)]++] = key;
    keys.swap(other);
  }
  std::vector<std::uint32_t> order;
  order.reserve(keys.size());
  for (const Key& key : keys) order.push_back(key.second);
  return order;
}

}  // namespace sightline
