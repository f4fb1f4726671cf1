// The table behind lane_ids.inl.hpp. Internal.
#pragma once

#include <array>
#include <cstdint>

namespace sightline {

/// The numbers of the set bits of a byte, ascending; zeros follow.
inline constexpr auto lanes_of_bits = [] {
  std::array<std::array<std::uint8_t, 8>, 256> table{};
  for (std::size_t bits = 0; bits < 256; ++bits)
    for (std::size_t lane = 0, n = 0; lane < 8; ++lane)
      if (((bits >> lane) & 1u) != 0) table[bits][n++] = static_cast<std::uint8_t>(lane);
  return table;
}();

}  // namespace sightline
