// Last stages: the tests of a fragment in the documented order - scissor, alpha, stencil, depth - and what it writes:
// blend, masks (checklist 4.08, 8.05 with E14: depth is written on pass, under its mask).
#pragma once

#include <cstdint>

#include "sightline/raster/target.hpp"

namespace sightline::raster {

/// What the work was. Stages in their order; a fragment that fails one does not reach the next.
struct DrawCounts {
  std::uint64_t triangles = 0;         // given
  std::uint64_t triangles_culled = 0;  // by facing
  std::uint64_t triangles_filled = 0;  // after clipping: covered at least one pixel's box
  std::uint64_t fragments = 0;         // covered pixel centres
  std::uint64_t scissor_failed = 0;
  std::uint64_t program_runs = 0;  // fragment program
  std::uint64_t discarded = 0;     // by the program
  std::uint64_t alpha_failed = 0;
  std::uint64_t stencil_failed = 0;
  std::uint64_t depth_tests = 0;
  std::uint64_t depth_failed = 0;
  std::uint64_t depth_writes = 0;
  std::uint64_t stencil_writes = 0;
  std::uint64_t colour_writes = 0;
  bool early_tests = false;  // in the last draw: depth and stencil before the program
};

inline bool scissor_passes(const Scissor& s, int x, int y) {
  return !s.enabled || (x >= s.x && y >= s.y && x < s.x + s.width && y < s.y + s.height);
}

inline bool alpha_passes(const AlphaTest& test, float alpha) {
  return !test.enabled || passes(test.func, alpha, test.ref);
}

/// Stencil and depth test of one fragment with all their writes. True: the fragment lives.
inline bool stencil_and_depth(const State& state, bool front, std::uint32_t code, std::size_t at, Target& target,
                              DrawCounts& counts) {
  const StencilFace& side = front ? state.stencil.front : state.stencil.back;
  const auto stencil = [&](StencilOp op) {
    if (op == StencilOp::keep) return;
    const std::uint8_t value = apply(op, target.stencil[at], side.ref);
    const auto old = target.stencil[at];
    target.stencil[at] = static_cast<std::uint8_t>((old & ~side.write_mask) | (value & side.write_mask));
    ++counts.stencil_writes;
  };
  if (state.stencil.enabled) {
    const auto ref = static_cast<std::uint8_t>(side.ref & side.mask);
    const auto stored = static_cast<std::uint8_t>(target.stencil[at] & side.mask);
    if (!passes(side.func, ref, stored)) {
      ++counts.stencil_failed;
      stencil(side.sfail);
      return false;
    }
  }
  if (state.depth.enabled) {
    ++counts.depth_tests;
    if (!target.counts.depth_tests.empty()) ++target.counts.depth_tests[at];
    if (!passes(state.depth.func, code, target.depth[at])) {
      ++counts.depth_failed;
      if (state.stencil.enabled) stencil(side.zfail);
      return false;
    }
  }
  if (state.stencil.enabled) stencil(side.zpass);
  if (state.depth.enabled && state.depth.mask) {
    ++counts.depth_writes;
    if (!target.counts.depth_writes.empty()) ++target.counts.depth_writes[at];
    target.depth[at] = code;
  }
  return true;
}

/// Blends and writes what the colour mask lets through.
inline void write_colour(const State& state, const glm::vec4& colour, std::size_t at, Target& target,
                         DrawCounts& counts) {
  std::uint32_t mask = 0;
  for (std::size_t i = 0; i < 4; ++i) mask |= state.color_mask[i] ? 0xFFu << (8 * i) : 0u;
  if (mask == 0) return;
  const std::uint32_t stored = target.colour[at];
  const std::uint32_t value =
      pack_colour(state.blend.enabled ? blended(state.blend, colour, unpack_colour(stored)) : colour);
  target.colour[at] = (stored & ~mask) | (value & mask);
  ++counts.colour_writes;
  if (!target.counts.colour_writes.empty()) ++target.counts.colour_writes[at];
}

}  // namespace sightline::raster
