#include "sightline/index/morton_order.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <stdexcept>
#include <utility>

namespace sightline {
namespace {

constexpr int bits_per_axis = 12, code_bits = 3 * bits_per_axis;
static_assert(code_bits + morton_box_bits == 64);

/// Bit i of an index goes to bit 3 i.
constexpr std::array<std::uint32_t, 64> spread_table = [] {
  std::array<std::uint32_t, 64> table{};
  for (std::uint32_t v = 0; v < table.size(); ++v)
    for (std::uint32_t i = 0; i < 6; ++i) table[v] |= ((v >> i) & 1u) << (3 * i);
  return table;
}();
std::uint64_t spread(std::uint32_t v) { return std::uint64_t{spread_table[v >> 6]} << 18 | spread_table[v & 63]; }

/// `cell`: metres that a cell of the finest codes is wide; infinity if all centres coincide.
PagedVector<MortonKey> morton_keys(std::span<const Aabb> boxes, float& cell) {
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
  cell = scale > 0.0f ? 0.5f / scale : std::numeric_limits<float>::infinity();  // the scale is that of twice the centre
  PagedVector<MortonKey> keys(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const glm::vec3 place = (boxes[i].lo + boxes[i].hi - lo) * scale;
    std::uint32_t at[3];
    for (int axis = 0; axis < 3; ++axis) {
      const float p = place[axis] > 0.0f ? place[axis] : 0.0f;
      at[axis] = static_cast<std::uint32_t>(p < cells - 1.0f ? p : cells - 1.0f);
    }
    keys[i] = (spread(at[0]) << 2 | spread(at[1]) << 1 | spread(at[2])) << morton_box_bits | i;
  }
  return keys;
}

/// By code, four passes of nine bits (least significant digit first: stable, so equal codes stay in order).
void radix_sort(PagedVector<MortonKey>& keys) {
  constexpr std::size_t digits = 4, radix = 1u << (code_bits / digits);
  std::vector<std::array<std::uint32_t, radix>> counts(digits);
  for (auto& c : counts) c.fill(0);
  const auto digit = [](MortonKey key, std::size_t pass) {
    return static_cast<std::size_t>(key >> (morton_box_bits + pass * (code_bits / digits))) & (radix - 1);
  };
  for (const MortonKey key : keys)
    for (std::size_t pass = 0; pass < digits; ++pass) ++counts[pass][digit(key, pass)];
  PagedVector<MortonKey> other(keys.size());
  for (std::size_t pass = 0; pass < digits; ++pass) {
    std::uint32_t sum = 0;
    for (std::uint32_t& c : counts[pass]) sum += std::exchange(c, sum);
    for (const MortonKey key : keys) other[counts[pass][digit(key, pass)]++] = key;
    keys.swap(other);
  }
}

/// Cuts all keys into runs of at most `most`, in order; a run of one code alone may be longer.
std::vector<MortonRun> morton_runs(std::span<const MortonKey> keys, std::uint32_t most) {
  std::vector<MortonRun> runs, stack;
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

/// Edge of the cell that all codes of a sorted run lie in, in cells of the finest codes.
float shared_edge(std::span<const MortonKey> keys, MortonRun run) {
  const auto levels = (std::bit_width(code_of(keys[run.begin]) ^ code_of(keys[run.end - 1])) + 2) / 3;
  return static_cast<float>(1u << levels);
}

}  // namespace

std::uint32_t cut(std::span<const MortonKey> keys, MortonRun run) {
  const auto [begin, end] = run;
  const std::uint64_t first = code_of(keys[begin]), last = code_of(keys[end - 1]);
  if (first == last) return begin + (end - begin) / 2;
  const std::uint64_t bit = std::bit_floor(first ^ last);
  const std::uint64_t bound = (last & ~(bit - 1));
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

MortonGroups morton_groups(std::span<const Aabb> boxes, std::uint32_t most) {
  if (boxes.size() >> morton_box_bits != 0) throw std::length_error("more than 2^28 boxes");
  float cell = 0.0f;
  MortonGroups groups{morton_keys(boxes, cell), {}, {}};
  radix_sort(groups.keys);
  const auto add = [&](std::uint32_t begin, std::uint32_t end) {
    Aabb bounds;
    for (std::uint32_t i = begin; i < end; ++i)
      if (const Aabb& box = boxes[box_of(groups.keys[i])]; !box.empty()) bounds.extend(box);
    groups.runs.push_back({begin, end});
    groups.bounds.push_back(bounds);
  };
  constexpr std::uint32_t ahead = 64;  // boxes are anywhere in memory
  const auto count = static_cast<std::uint32_t>(boxes.size());
  for (const MortonRun& run : morton_runs(groups.keys, most)) {
    for (std::uint32_t i = run.begin + ahead; i < std::min(run.end + ahead, count); ++i)
      __builtin_prefetch(&boxes[box_of(groups.keys[i])]);
    const float edge = cell * shared_edge(groups.keys, run);
    const auto first = groups.keys.begin();
    const auto fits = [&](MortonKey key) {
      const Aabb& box = boxes[box_of(key)];
      return !(box.hi.x - box.lo.x > edge || box.hi.y - box.lo.y > edge || box.hi.z - box.lo.z > edge);
    };
    const auto large =
        static_cast<std::uint32_t>(std::stable_partition(first + run.begin, first + run.end, fits) - first);
    if (large > run.begin) add(run.begin, large);
    for (std::uint32_t i = large; i < run.end; ++i) add(i, i + 1);
  }
  return groups;
}

}  // namespace sightline
