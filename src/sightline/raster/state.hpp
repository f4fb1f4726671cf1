// What a draw call depends on besides its triangles: names, meanings and defaults are OpenGL's (checklist 3.20, 4.09,
// 7.08, 8.02-8.04, 8.10 with E12-E14), but rows count from the top, as everywhere in sightline.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

namespace sightline::raster {

/// glDepthFunc, glStencilFunc, glAlphaFunc: `incoming func stored`. For stencil that is (ref & mask) func (s & mask):
/// OpenGL's order of the operands, not the slide's (E13).
enum class Compare : std::uint8_t { never, less, equal, lequal, greater, notequal, gequal, always };

enum class StencilOp : std::uint8_t { keep, zero, replace, incr, decr, invert, incr_wrap, decr_wrap };

enum class BlendFactor : std::uint8_t {
  zero,
  one,
  src_color,
  one_minus_src_color,
  dst_color,
  one_minus_dst_color,
  src_alpha,
  one_minus_src_alpha,
  dst_alpha,
  one_minus_dst_alpha,
  constant_color,
  one_minus_constant_color,
  constant_alpha,
  one_minus_constant_alpha,
  src_alpha_saturate
};

enum class BlendEquation : std::uint8_t { add, subtract, reverse_subtract, min, max };

enum class CullFace : std::uint8_t { none, front, back, both };

/// glStencilFuncSeparate, glStencilOpSeparate, glStencilMaskSeparate of one side.
struct StencilFace {
  Compare func = Compare::always;
  std::uint8_t ref = 0, mask = 0xFF;
  StencilOp sfail = StencilOp::keep, zfail = StencilOp::keep, zpass = StencilOp::keep;
  std::uint8_t write_mask = 0xFF;
};

struct Scissor {
  bool enabled = false;
  int x = 0, y = 0, width = 0, height = 0;  // pixels; y of the top row, counted from the top
};

struct AlphaTest {
  bool enabled = false;
  Compare func = Compare::always;
  float ref = 0.0f;
};

struct StencilTest {
  bool enabled = false;
  StencilFace front, back;  // two-sided in one pass (8.11)
};

struct DepthTest {
  bool enabled = true;  // off: neither test nor write, as in OpenGL
  Compare func = Compare::less;
  bool mask = true;  // glDepthMask
};

struct Blend {
  bool enabled = false;
  BlendFactor src_rgb = BlendFactor::one, dst_rgb = BlendFactor::zero;
  BlendFactor src_alpha = BlendFactor::one, dst_alpha = BlendFactor::zero;
  BlendEquation rgb = BlendEquation::add, alpha = BlendEquation::add;
  glm::vec4 constant{0.0f};
};

struct State {
  Scissor scissor;
  AlphaTest alpha_test;
  StencilTest stencil;
  DepthTest depth;
  Blend blend;
  std::array<bool, 4> color_mask{true, true, true, true};
  CullFace cull = CullFace::none;
  bool front_is_ccw = true;  // counter-clockwise as seen on the screen
  /// Depth and stencil tests before the program where that changes nothing (4.03, E6). Off: always after it.
  bool early_tests = true;
};

/// The blends that the slides name (7.01, 7.02, 7.08; glBlendFunc, E12).
Blend blend_over();      // C = alpha A + (1 - alpha) S
Blend blend_additive();  // C = A + S
Blend blend_filter();    // C = A * S: coloured glass, A is its transmission

/// `a func b`.
template <class T>
constexpr bool passes(Compare func, T a, T b) {
  switch (func) {
    case Compare::never:
      return false;
    case Compare::less:
      return a < b;
    case Compare::equal:
      return a == b;
    case Compare::lequal:
      return a <= b;
    case Compare::greater:
      return a > b;
    case Compare::notequal:
      return a != b;
    case Compare::gequal:
      return a >= b;
    case Compare::always:
      return true;
  }
  return true;
}

/// The stencil value after `op`, before the write mask.
std::uint8_t apply(StencilOp op, std::uint8_t stored, std::uint8_t ref);

/// The colour that blending gives; components clamped to [0, 1] first, as for a fixed-point colour buffer.
glm::vec4 blended(const Blend& blend, const glm::vec4& source, const glm::vec4& destination);

}  // namespace sightline::raster
