#include "sightline/raster/state.hpp"

#include <algorithm>

namespace sightline::raster {
namespace {

glm::vec4 factor(BlendFactor f, const glm::vec4& s, const glm::vec4& d, const glm::vec4& c) {
  const glm::vec4 one(1.0f);
  switch (f) {
    case BlendFactor::zero:
      return glm::vec4(0.0f);
    case BlendFactor::one:
      return one;
    case BlendFactor::src_color:
      return s;
    case BlendFactor::one_minus_src_color:
      return one - s;
    case BlendFactor::dst_color:
      return d;
    case BlendFactor::one_minus_dst_color:
      return one - d;
    case BlendFactor::src_alpha:
      return glm::vec4(s.a);
    case BlendFactor::one_minus_src_alpha:
      return glm::vec4(1.0f - s.a);
    case BlendFactor::dst_alpha:
      return glm::vec4(d.a);
    case BlendFactor::one_minus_dst_alpha:
      return glm::vec4(1.0f - d.a);
    case BlendFactor::constant_color:
      return c;
    case BlendFactor::one_minus_constant_color:
      return one - c;
    case BlendFactor::constant_alpha:
      return glm::vec4(c.a);
    case BlendFactor::one_minus_constant_alpha:
      return glm::vec4(1.0f - c.a);
    case BlendFactor::src_alpha_saturate: {
      const float f_sat = std::min(s.a, 1.0f - d.a);
      return {f_sat, f_sat, f_sat, 1.0f};
    }
  }
  return one;
}

glm::vec4 equation(BlendEquation e, const glm::vec4& s, const glm::vec4& fs, const glm::vec4& d, const glm::vec4& fd) {
  switch (e) {
    case BlendEquation::add:
      return s * fs + d * fd;
    case BlendEquation::subtract:
      return s * fs - d * fd;
    case BlendEquation::reverse_subtract:
      return d * fd - s * fs;
    case BlendEquation::min:
      return glm::min(s, d);  // minimum and maximum take no factors
    case BlendEquation::max:
      return glm::max(s, d);
  }
  return s;
}

}  // namespace

Blend blend_over() {
  Blend b;
  b.enabled = true;
  b.src_rgb = b.src_alpha = BlendFactor::src_alpha;
  b.dst_rgb = b.dst_alpha = BlendFactor::one_minus_src_alpha;
  return b;
}

Blend blend_additive() {
  Blend b;
  b.enabled = true;
  b.dst_rgb = b.dst_alpha = BlendFactor::one;
  return b;
}

Blend blend_filter() {
  Blend b;
  b.enabled = true;
  b.src_rgb = b.src_alpha = BlendFactor::zero;
  b.dst_rgb = b.dst_alpha = BlendFactor::src_color;
  return b;
}

std::uint8_t apply(StencilOp op, std::uint8_t stored, std::uint8_t ref) {
  switch (op) {
    case StencilOp::keep:
      return stored;
    case StencilOp::zero:
      return 0;
    case StencilOp::replace:
      return ref;
    case StencilOp::incr:
      return stored == 0xFF ? stored : static_cast<std::uint8_t>(stored + 1);
    case StencilOp::decr:
      return stored == 0 ? stored : static_cast<std::uint8_t>(stored - 1);
    case StencilOp::invert:
      return static_cast<std::uint8_t>(~stored);
    case StencilOp::incr_wrap:
      return static_cast<std::uint8_t>(stored + 1);
    case StencilOp::decr_wrap:
      return static_cast<std::uint8_t>(stored - 1);
  }
  return stored;
}

glm::vec4 blended(const Blend& blend, const glm::vec4& source, const glm::vec4& d) {
  const glm::vec4 s = glm::clamp(source, 0.0f, 1.0f), c = glm::clamp(blend.constant, 0.0f, 1.0f);
  const glm::vec4 rgb = equation(blend.rgb, s, factor(blend.src_rgb, s, d, c), d, factor(blend.dst_rgb, s, d, c));
  const glm::vec4 alpha =
      equation(blend.alpha, s, factor(blend.src_alpha, s, d, c), d, factor(blend.dst_alpha, s, d, c));
  return glm::clamp(glm::vec4(rgb.r, rgb.g, rgb.b, alpha.a), 0.0f, 1.0f);
}

}  // namespace sightline::raster
