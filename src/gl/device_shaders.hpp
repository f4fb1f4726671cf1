// Shaders of the methods that cull on the device: what was seen first, the pyramid of depths, the tests against it, and
// boxes that write what is seen. Each is preceded by SceneDrawing::frame_block() and buffers_glsl unless it names its
// version itself. Depth is reversed: nearer is larger.
#pragma once

namespace sightline::gl {

/// Buffers that all kernels see. A group is a subtree of the hierarchy with at most 64 objects, which lie side by side
/// in `items`; the highest bit of an item says that it is no candidate.
inline constexpr char buffers_glsl[] = R"(
struct Command { uint index_count, instances, first_index; int base_vertex; uint base_instance; };
struct Group { vec4 lo, hi; uvec4 range; };  // begin, count
layout(std430, binding = 1) readonly buffer Bounds { vec4 bounds[]; };
layout(std430, binding = 2) readonly buffer Groups { Group groups[]; };
layout(std430, binding = 3) readonly buffer Items { uint items[]; };
layout(std430, binding = 4) buffer Seen { uint seen[]; };      // objects, then groups: 1 seen now
layout(std430, binding = 5) buffer Drawn { uint drawn[]; };    // objects: 1 drawn first
layout(std430, binding = 6) readonly buffer Templates { Command templates[]; };
layout(std430, binding = 7) buffer Out { Command commands[]; };  // two lists
layout(std430, binding = 8) buffer Counts { uint counts[]; };    // commands of the lists; tests; boxes of a draw
const uint no_candidate = 0x80000000u;

bool outside(vec3 lo, vec3 hi) {
  for (int i = 0; i < frame.size.z; ++i) {
    vec4 plane = frame.planes[i];
    if (dot(plane.xyz, mix(lo, hi, greaterThanEqual(plane.xyz, vec3(0.0)))) + plane.w < 0.0) return true;
  }
  return false;
}

/// The eye may be in the box, or the near plane may cut it.
bool near_or_inside(vec3 lo, vec3 hi) {
  vec3 half_extent = 0.5 * (hi - lo), centre = 0.5 * (lo + hi) - frame.eye.xyz;
  float nearest = dot(frame.forward.xyz, centre) - dot(abs(frame.forward.xyz), half_extent);
  float slack = 4.0 * (frame.eye.w * frame.forward.w + rounding_of(lo, hi) + 1e-6 * length(frame.eye.xyz));
  return nearest <= frame.forward.w + slack + 2.0 * frame.eye.w * (frame.size.w == 1 ? abs(nearest) : 1.0);
}

void append(uint list, uint id) {
  uint place = atomicAdd(counts[list], 1u);
  commands[list * uint(bounds.length() / 2) + place] = templates[id];
}
)";

/// Phase one: what was seen in the last frame.
inline constexpr char first_glsl[] = R"(
layout(local_size_x = 64) in;
void main() {
  Group group = groups[gl_WorkGroupID.x];
  if (gl_LocalInvocationID.x >= group.range.y) return;
  uint item = items[group.range.x + gl_LocalInvocationID.x];
  uint id = item & ~no_candidate;
  bool first = seen[id] != 0u && item < no_candidate && !outside(bounds[2u * id].xyz, bounds[2u * id + 1u].xyz);
  drawn[id] = first ? 1u : 0u;
  if (first) append(0u, id);
}
)";

/// One level of the pyramid from the one below: the farthest (smallest) depth of 2 x 2, or of the picture.
inline constexpr char pyramid_glsl[] = R"(
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2D below;
layout(binding = 0, r32f) writeonly uniform image2D above;
layout(location = 0) uniform int level_below;
layout(location = 1) uniform ivec2 last;  // of the level below that belongs to the picture
void main() {
  ivec2 p = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(p, imageSize(above)))) return;
  ivec2 q = 2 * p;
  float a = texelFetch(below, min(q, last), level_below).r;
  float b = texelFetch(below, min(q + ivec2(1, 0), last), level_below).r;
  float c = texelFetch(below, min(q + ivec2(0, 1), last), level_below).r;
  float d = texelFetch(below, min(q + ivec2(1, 1), last), level_below).r;
  imageStore(above, p, vec4(min(min(a, b), min(c, d))));
}
)";

inline constexpr char hidden_glsl[] = R"(
layout(binding = 0) uniform sampler2D pyramid;
layout(location = 1) uniform int levels;

bool covered(ivec2 from, ivec2 to, int level, float nearest) {
  ivec2 a = from >> (level + 1), b = to >> (level + 1);
  for (int y = a.y; y <= b.y; ++y)
    for (int x = a.x; x <= b.x; ++x)
      if (texelFetch(pyramid, ivec2(x, y), level).r <= nearest) return false;  // nearer is larger
  return true;
}

/// True if every pixel that the widened box may touch has something nearer than the nearest point of the box.
bool hidden(vec3 lo, vec3 hi) {
  if (near_or_inside(lo, hi)) return false;
  float nearest = 0.0;
  vec2 from = vec2(1e30), to = vec2(-1e30);
  for (int i = 0; i < 8; ++i) {
    vec4 q = asked_corner(lo, hi, vec3(i & 1, (i >> 1) & 1, (i >> 2) & 1));
    vec3 ndc = q.xyz / q.w;
    from = min(from, ndc.xy);
    to = max(to, ndc.xy);
    nearest = max(nearest, ndc.z);
  }
  nearest += 2e-6 * nearest + (frame.size.w == 0 ? 2e-6 : 0.0);
  vec2 size = vec2(frame.size.xy);
  ivec2 a = ivec2(clamp(floor((0.5 + 0.5 * from) * size), vec2(0.0), size - 1.0));
  ivec2 b = ivec2(clamp(floor((0.5 + 0.5 * to) * size), vec2(0.0), size - 1.0));
  int span = max(b.x - a.x, b.y - a.y) + 1;
  int coarse = clamp(findMSB(span), 0, levels - 1);  // at most 2 x 2 texels, often
  if (covered(a, b, coarse, nearest)) return true;
  return coarse > 1 && covered(a, b, max(0, coarse - FINER), nearest);
}
)";

/// Phase two: everything against the pyramid, groups first.
inline constexpr char second_glsl[] = R"(
layout(local_size_x = 64) in;
void main() {
  Group group = groups[gl_WorkGroupID.x];
  if (gl_LocalInvocationID.x >= group.range.y) return;
  uint item = items[group.range.x + gl_LocalInvocationID.x];
  uint id = item & ~no_candidate;
  bool visible = item < no_candidate && !outside(group.lo.xyz, group.hi.xyz) && !hidden(group.lo.xyz, group.hi.xyz);
  if (visible) {
    vec3 lo = bounds[2u * id].xyz, hi = bounds[2u * id + 1u].xyz;
    visible = !outside(lo, hi) && !hidden(lo, hi);
  }
  seen[id] = visible ? 1u : 0u;
  if (visible && drawn[id] == 0u) append(1u, id);
}
)";

// ---- boxes that write

/// Which boxes are drawn: mode 0, the groups in the frustum; mode 1, the objects of groups that were seen.
inline constexpr char boxes_glsl[] = R"(
layout(local_size_x = 64) in;
layout(std430, binding = 9) writeonly buffer List { uint list[]; };
layout(location = 0) uniform int mode;
layout(location = 1) uniform uint group_count;
void main() {
  uint objects = uint(bounds.length() / 2);
  if (mode == 0) {
    uint g = gl_GlobalInvocationID.x;
    if (g >= group_count) return;
    vec3 lo = groups[g].lo.xyz, hi = groups[g].hi.xyz;
    seen[objects + g] = 0u;
    if (outside(lo, hi)) return;
    if (near_or_inside(lo, hi)) seen[objects + g] = 1u;
    else list[atomicAdd(counts[5], 1u)] = g;
    return;
  }
  Group group = groups[gl_WorkGroupID.x];
  if (gl_LocalInvocationID.x >= group.range.y) return;
  uint item = items[group.range.x + gl_LocalInvocationID.x];
  uint id = item & ~no_candidate;
  seen[id] = 0u;
  if (seen[objects + gl_WorkGroupID.x] == 0u || item >= no_candidate) return;
  vec3 lo = bounds[2u * id].xyz, hi = bounds[2u * id + 1u].xyz;
  if (outside(lo, hi)) return;
  if (near_or_inside(lo, hi)) seen[id] = 1u;
  else list[atomicAdd(counts[9], 1u)] = id;
}
)";

inline constexpr char box_vertex_glsl[] = R"(
layout(location = 0) in vec3 corner;
layout(std430, binding = 9) readonly buffer List { uint list[]; };
layout(location = 0) uniform int mode;
flat out uint flag;
void main() {
  uint which = list[gl_InstanceID];
  vec3 lo = mode == 0 ? groups[which].lo.xyz : bounds[2u * which].xyz;
  vec3 hi = mode == 0 ? groups[which].hi.xyz : bounds[2u * which + 1u].xyz;
  flag = mode == 0 ? uint(bounds.length() / 2) + which : which;
  gl_Position = asked_corner(lo, hi, corner);
}
)";

inline constexpr char box_fragment_glsl[] = R"(#version 450 core
layout(early_fragment_tests) in;
layout(std430, binding = 4) buffer Seen { uint seen[]; };
flat in uint flag;
void main() { if (seen[flag] == 0u) seen[flag] = 1u; }
)";

/// After the boxes: what is seen and not yet drawn.
inline constexpr char newly_glsl[] = R"(
layout(local_size_x = 64) in;
void main() {
  Group group = groups[gl_WorkGroupID.x];
  if (gl_LocalInvocationID.x >= group.range.y) return;
  uint item = items[group.range.x + gl_LocalInvocationID.x];
  uint id = item & ~no_candidate;
  if (seen[id] != 0u && drawn[id] == 0u) append(1u, id);
}
)";

}  // namespace sightline::gl
