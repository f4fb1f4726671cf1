#include "sightline/index/morton_order.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <utility>

namespace sightline {
namespace {

constexpr int bits_per_axis = 10, code_bits = 3 * bits_per_axis;

/// Moves bit i of the lowest ten to bit 3 i.
std::uint32_t spread(std::uint32_t v) {
  v = (v * 0x00010001u) & 0xFF0000FFu;
  v = (v * 0x00000101u) & 0x0F00F00Fu;
  v = (v * 0x00000011u) & 0xC30C30C3u;
  return (v * 0x00000005u) & 0x49249249u;
}

std::vector<MortonKey> morton_keys(std::span<const Aabb> boxes) {
  glm::vec3 lo(std::numeric_limits<float>::infinity()), hi = -lo;
  for (const Aabb& box : boxes) {
    const glm::vec3 c = box.lo + box.hi;  // of an empty box NaN, which no comparison takes
    for (int axis = 0; axis < 3; ++axis) {
      lo[axis] = c[axis] < lo[axis] ? c[axis] : lo[axis];
      hi[axis] = c[axis] > hi[axis] ? c[axis] : hi[axis];
    }
  }
  constexpr float cells = 1u << bits_per_axis;
  // Cubes, however flat the scene: their groups are compact.
  const float longest = std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z}), per_unit = cells / longest;
  const float scale = per_unit > 0.0f && per_unit < std::numeric_limits<float>::infinity() ? per_unit : 0.0f;
  std::vector<MortonKey> keys(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const glm::vec3 place = (boxes[i].lo + boxes[i].hi - lo) * scale;
    std::uint32_t cell[3];
    for (int axis = 0; axis < 3; ++axis) {
      const float p = place[axis] > 0.0f ? place[axis] : 0.0f;
      cell[axis] = static_cast<std::uint32_t>(p < cells - 1.0f ? p : cells - 1.0f);
    }
    keys[i] = (MortonKey{spread(cell[0]) << 2 | spread(cell[1]) << 1 | spread(cell[2])} << 32) | i;
  }
  return keys;
}

/// By code, three passes of ten bits (least significant digit first: stable, so equal codes stay in order).
void radix_sort(std::vector<MortonKey>& keys) {
  constexpr std::size_t digits = 3, radix = 1u << (code_bits / digits);
  std::vector<std::array<std::uint32_t, radix>> counts(digits);
  for (auto& c : counts) c.fill(0);
  const auto digit = [](MortonKey key, std::size_t pass) {
    return static_cast<std::size_t>(key >> (32 + pass * (code_bits / digits))) & (radix - 1);
  };
  for (const MortonKey key : keys)
    for (std::size_t pass = 0; pass < digits; ++pass) ++counts[pass][digit(key, pass)];
  std::vector<MortonKey> other(keys.size());
  for (std::size_t pass = 0; pass < digits; ++pass) {
    std::uint32_t sum = 0;
    for (std::uint32_t& c : counts[pass]) sum += std::exchange(c, sum);
    for (const MortonKey key : keys) other[counts[pass][digit(key, pass)]++] = key;
    keys.swap(other);
  }
}

}  // namespace

std::vector<MortonKey> morton_order(std::span<const Aabb> boxes) {
  std::vector<MortonKey> keys = morton_keys(boxes);
  radix_sort(keys);
  return keys;
}

std::uint32_t cut(std::span<const MortonKey> keys, MortonRun run) {
  const auto [begin, end] = run;
  const std::uint32_t first = code_of(keys[begin]), last = code_of(keys[end - 1]);
  if (first == last) return begin + (end - begin) / 2;
  const std::uint32_t bit = std::bit_floor(first ^ last);
  const std::uint32_t bound = (last & ~(bit - 1));
  std::uint32_t low = begin, high = end - 1;
  while (low < high) {
    const std::uint32_t middle = low + (high - low) / 2;
    if (code_of(keys[middle]) < bound)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

std::vector<MortonRun> morton_runs(std::span<const MortonKey> keys, std::uint32_t most) {
  std::vector<MortonRun> runs;
  std::vector<MortonRun> stack;
  if (!keys.empty()) stack.push_back({0, static_cast<std::uint32_t>(keys.size())});
  while (!stack.empty()) {
    const MortonRun run = stack.back();
    stack.pop_back();
    if (run.end - run.begin <= most || code_of(keys[run.begin]) == code_of(keys[run.end - 1])) {
      runs.push_back(run);
      continue;
    }
    const std::uint32_t middle = cut(keys, run);
    stack.push_back({middle, run.end});
    stack.push_back({run.begin, middle});
  }
  return runs;
}

}  // namespace sightline
