// Shaders of the scene's objects and of boxes that are asked about, and the block of the frame that all programs see.
// Depth is reversed: nearer is larger.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace sightline::gl {

inline constexpr char frame_glsl[] = R"(#version 450 core
layout(std140, binding = 0) uniform Frame {
  mat4 clip;          // of points relative to the eye
  vec4 eye;           // w: half-open widening of boxes for each unit of w
  vec4 planes[6];     // world space, inside is >= 0
  vec4 forward;       // w: distance of the near plane
  ivec4 size;         // width, height, number of planes, perspective or not
  vec4 depth;         // x: share by which interpolated depth may be off; y: radius about the eye that holds the near plane
  vec4 shade;         // x, y: from the depth of a plane in the middle to its normal's z; z, w: middle of the window
  vec4 up;            // the world's up in view space
} frame;
)";

/// Boxes that are asked about, for whatever asks; follows frame_glsl.
inline constexpr char box_glsl[] = R"(
/// As SceneDrawing::one_sided, bit by bit: a subtraction and a comparison round in one way only.
bool one_sided(bool solid, vec3 lo, vec3 hi) {
  return solid && (any(lessThan(frame.eye.xyz, lo - frame.depth.y)) ||
                   any(greaterThan(frame.eye.xyz, hi + frame.depth.y)));
}

float rounding_of(vec3 lo, vec3 hi) {
  vec3 reach = max(abs(lo), abs(hi));
  return 1e-6 * max(reach.x, max(reach.y, reach.z));
}

/// A corner (0 or 1 on each axis) in clip space: widened by 1/16 pixel, so that the box covers each pixel centre that
/// its content covers, and nearer by what the content's depth may be off, but not before the near plane.
vec4 asked_corner(vec3 lo, vec3 hi, vec3 corner) {
  vec3 p = mix(lo, hi, corner) - frame.eye.xyz;
  float w = (frame.clip * vec4(p, 1.0)).w;
  float wide = frame.eye.w * abs(w) + rounding_of(lo, hi);
  vec4 q = frame.clip * vec4(p + (2.0 * corner - 1.0) * wide, 1.0);
  q.z = min(q.z + frame.depth.x * (frame.size.w == 1 ? abs(q.z) : 1.0), max(q.z, q.w));
  return q;
}
)";

inline constexpr char object_vertex[] = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 row0;
layout(location = 2) in vec4 row1;
layout(location = 3) in vec4 row2;
layout(location = 4) in uint object;
layout(location = 5) in vec4 tint;
flat out vec3 colour;
flat out uint id;
invariant gl_Position;
void main() {
  vec4 p = vec4(position, 1.0);
  vec3 from_eye = vec3(dot(row0, p), dot(row1, p), dot(row2, p)) - frame.eye.xyz;
  gl_Position = frame.clip * vec4(from_eye, 1.0);
  colour = tint.rgb;
  id = object;
}
)";

inline constexpr char object_fragment[] = R"(
flat in vec3 colour;
flat in uint id;
layout(location = 0) out vec4 shaded;
layout(location = 1) out uint object;
void main() {
  float z = gl_FragCoord.z;
  vec2 slope = vec2(dFdx(z), dFdy(z));
#ifdef LOOSE_DEPTH
  // The pixel is covered by corners on a grid of 1/256 pixel, its depth follows from corners off the grid.
  // Of a triangle without area it may be no number, so this is not the opposite comparison.
  if (!(abs(slope.x) + abs(slope.y) <= 500.0 * frame.depth.x * (frame.size.w == 1 ? z : 1.0))) discard;
#endif
  shaded = vec4(colour, 1.0);
#ifdef LIT
  // The triangle is a plane in the window too: brought back to view space it needs no points, and few constants.
  vec3 n = vec3(slope, frame.shade.x * (z + dot(slope, frame.shade.zw - gl_FragCoord.xy)) + frame.shade.y);
  shaded.rgb *= 0.35 + (0.4 * abs(n.z) + 0.25 * abs(dot(n, frame.up.xyz))) * inversesqrt(max(dot(n, n), 1e-30));
#endif
  object = id;
}
)";

inline constexpr char box_vertex[] = R"(
layout(location = 0) in vec3 corner;
layout(location = 1) in vec3 lo;
layout(location = 2) in vec3 hi;
void main() { gl_Position = asked_corner(lo, hi, corner); }
)";

inline constexpr char box_fragment[] = "void main() {}\n";

/// Corners of the unit cube as a strip of triangles that face outwards.
inline constexpr std::uint8_t cube_strip[14] = {6, 7, 2, 3, 1, 7, 5, 6, 4, 2, 0, 1, 4, 5};

struct FrameBlock {
  glm::mat4 clip;
  glm::vec4 eye;
  glm::vec4 planes[6];
  glm::vec4 forward;
  glm::ivec4 size;
  glm::vec4 depth;
  glm::vec4 shade, up;
};

}  // namespace sightline::gl
