#include "sightline/index/coherent_order.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "sightline/geometry/ray.hpp"
#include "sightline/index/bvh8.hpp"

namespace sightline {
namespace {

constexpr int bits = 4, kind_bits = 5, digits = 3, digit_bits = 10;
static_assert(6 * bits + kind_bits <= digits * digit_bits);
constexpr std::size_t radix = 1u << digit_bits, cells = 1u << bits, neighbours = 8;

/// Bit i of a cell goes to bit 6 i.
constexpr std::array<std::uint32_t, cells> spread = [] {
  std::array<std::uint32_t, cells> table{};
  for (std::uint32_t v = 0; v < cells; ++v)
    for (std::uint32_t i = 0; i < bits; ++i) table[v] |= ((v >> i) & 1u) << (6 * i);
  return table;
}();

/// The octant of a direction and its largest axis: less than 2^kind_bits.
std::uint32_t kind_of(const glm::vec3& d) {
  const glm::vec3 size = magnitudes(d);
  const auto is = [](bool b) { return static_cast<std::uint32_t>(b); };
  const std::uint32_t last = is(size.z > std::max(size.x, size.y));
  return (2 * last + (1 - last) * is(size.y > size.x)) << 3 | is(d.x < 0.0f) << 2 | is(d.y < 0.0f) << 1 |
         is(d.z < 0.0f);
}

}  // namespace

std::vector<std::uint32_t> coherent_order(const Aabb& bounds, std::span<const Segment> segments) {
  using Key = std::pair<std::uint32_t, std::uint32_t>;  // code, segment
  const glm::vec3 extent = glm::max(bounds.empty() ? glm::vec3(0.0f) : bounds.extent(), 1e-30f);
  const glm::vec3 scale = static_cast<float>(cells) / extent;
  std::vector<Key> keys(segments.size()), other(segments.size());
  std::array<std::array<std::uint32_t, radix>, digits> counts{};
  for (std::uint32_t i = 0; i < keys.size(); ++i) {
    std::uint32_t code = kind_of(segments[i].b - segments[i].a) << (6 * bits);
    for (int axis = 0; axis < 3; ++axis) {
      const float a = (segments[i].a[axis] - bounds.lo[axis]) * scale[axis];
      const float b = (segments[i].b[axis] - bounds.lo[axis]) * scale[axis];
      // Comparisons that a NaN fails.
      const auto cell = [](float p) {
        constexpr auto last = static_cast<float>(cells - 1);
        return static_cast<std::uint32_t>(p > 0.0f ? (p < last ? p : last) : 0.0f);
      };
      code |= spread[cell(a)] << (2 * axis + 1) | spread[cell(b)] << (2 * axis);
    }
    keys[i] = {code, i};
    for (std::size_t d = 0; d < digits; ++d) ++counts[d][(code >> (digit_bits * d)) & (radix - 1)];
  }
  for (std::size_t d = 0; d < digits; ++d) {
    std::uint32_t sum = 0;
    for (std::uint32_t& c : counts[d]) sum += std::exchange(c, sum);
    for (const Key& key : keys) other[counts[d][(key.first >> (digit_bits * d)) & (radix - 1)]++] = key;
    keys.swap(other);
  }
  // Neighbours that share an eighth of the bounds with both ends.
  std::size_t together = 0;
  for (std::size_t i = 0; i + neighbours <= keys.size(); i += neighbours)
    together += (keys[i].first ^ keys[i + neighbours - 1].first) >> (6 * (bits - 3)) == 0 ? 1 : 0;
  std::vector<std::uint32_t> order;
  if (2 * neighbours * together < keys.size()) return order;
  order.reserve(keys.size());
  for (const Key& key : keys) order.push_back(key.second);
  return order;
}

}  // namespace sightline
