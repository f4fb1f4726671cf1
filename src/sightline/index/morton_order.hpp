// Boxes along a space-filling curve (Morton 1966), and the curve cut into runs by its leading bits: neighbours in the
// order are neighbours in space. What the builders of large trees start from.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/geometry/aabb.hpp"
#include "sightline/index/large_pages.hpp"

namespace sightline {

/// The Morton code of a box's centre (twelve bits per axis) above, the number of the box in the lower 28 bits.
using MortonKey = std::uint64_t;
inline constexpr int morton_box_bits = 28;
inline std::uint64_t code_of(MortonKey key) { return key >> morton_box_bits; }
inline std::uint32_t box_of(MortonKey key) { return static_cast<std::uint32_t>(key) & ((1u << morton_box_bits) - 1u); }

/// Keys [begin, end).
struct MortonRun {
  std::uint32_t begin, end;
};

/// Where the highest differing bit of the codes of a run changes; its middle if all are equal. Within (begin, end) for
/// runs of two and more, which must be sorted.
std::uint32_t cut(std::span<const MortonKey> keys, MortonRun run);

/// All boxes, group after group, and what bounds each group.
struct MortonGroups {
  PagedVector<MortonKey> keys;
  std::vector<MortonRun> runs;
  std::vector<Aabb> bounds;  // of the runs; empty boxes do not count
};

/// Groups of at most `most` boxes (1 or more) that share a cell of the curve; in a group keys are sorted, and boxes of
/// equal code keep their order. Boxes of one code alone stay one group, however many; a box larger than the cell that
/// its group shares is a group of its own, because it would spoil the group's bounds. O(n log n / most). Throws
/// std::length_error above 2^28 boxes.
MortonGroups morton_groups(std::span<const Aabb> boxes, std::uint32_t most);

}  // namespace sightline
