// What became of each object in a frame, and the colour that says so.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "sightline/core/visible_set.hpp"

namespace sightline::viewer {

enum class Standing : std::uint8_t { seen, outside, occluded, detail };

/// 0xAABBGGRR and a word for the legend, by Standing.
struct Look {
  std::uint32_t colour;
  std::string_view word;
};
inline constexpr std::array<Look, 4> looks{{{0xff50b43cu, "seen"},
                                            {0xffb4a08cu, "outside the frustum"},
                                            {0xff3c5adcu, "occluded"},
                                            {0xff32c8f0u, "too small"}}};

/// Standing of every object: `frustum` are the objects that the frustum leaves, `large` those that detail culling
/// leaves (null: no detail culling), `visible` those that the method leaves. What is visible is seen.
std::vector<Standing> standings(const VisibleSet& frustum, const VisibleSet* large, const VisibleSet& visible);

std::array<std::size_t, 4> count(std::span<const Standing> standings);
std::vector<std::uint32_t> colours_of(std::span<const Standing> standings);

}  // namespace sightline::viewer
