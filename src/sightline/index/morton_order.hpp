// Boxes along a space-filling curve (Morton 1966), and the curve cut into runs by its leading bits: neighbours in the
// order are neighbours in space. What the builders of large trees start from.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/geometry/aabb.hpp"

namespace sightline {

/// The Morton code of a box's centre (ten bits per axis) above, the number of the box below.
using MortonKey = std::uint64_t;
inline std::uint32_t code_of(MortonKey key) { return static_cast<std::uint32_t>(key >> 32); }
inline std::uint32_t box_of(MortonKey key) { return static_cast<std::uint32_t>(key); }

/// A key for every box, sorted; boxes of equal code keep their order. O(n).
std::vector<MortonKey> morton_order(std::span<const Aabb> boxes);

/// Keys [begin, end).
struct MortonRun {
  std::uint32_t begin, end;
};

/// Where the highest differing bit of the codes of a run changes; its middle if all are equal. Within (begin, end) for
/// runs of two and more.
std::uint32_t cut(std::span<const MortonKey> keys, MortonRun run);

/// Cuts all keys into runs of at most `most` (1 or more), in order; a run of one code alone may be longer.
std::vector<MortonRun> morton_runs(std::span<const MortonKey> keys, std::uint32_t most);

}  // namespace sightline
