// The number that no triangle has.
#pragma once

#include <cstdint>

namespace sightline {

inline constexpr std::uint32_t no_triangle = 0xFFFFFFFFu;

}  // namespace sightline
