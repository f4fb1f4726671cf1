// Shaders of the methods that cull on the device: what was seen first, the pyramid of depths, the tests against it, and
// boxes that write what is seen. Each is preceded by SceneDrawing::frame_block() and buffers_glsl unless it names its
// version itself. Depth is reversed: nearer is larger.
#pragma once

namespace sightline::gl {

/// Buffers that all kernels see. A group is a subtree of the hierarchy with a few dozen objects, which lie side by side
/// in `items`; the highest bit of an item says that it is no candidate.
inline constexpr char buffers_glsl[] = R"(
struct Command { uint index_count, instances, first_index; int base_vertex; uint base_instance; };
struct Group { vec4 lo, hi; uvec4 range; };  // begin, count
layout(std430, binding = 1) readonly buffer Bounds { vec4 bounds[]; };
layout(std430, binding = 2) readonly buffer Groups { Group groups[]; };
layout(std430, binding = 3) readonly buffer Items { uint items[]; };
layout(std430, binding = 4) buffer Seen { uint seen[]; };      // objects, then groups: frame in which it was seen
layout(std430, binding = 5) buffer Drawn { uint drawn[]; };    // objects: frame in which it was drawn first
layout(std430, binding = 6) readonly buffer Templates { Command templates[]; };
layout(std430, binding = 7) buffer Out { Command commands[]; };  // four lists: for each phase one-sided objects, others
layout(std430, binding = 8) buffer Counts {
  uint command_count[4];  // of the four lists
  uint now, read_list;    // number of the frame; which list of places tells what the last frame saw
  uint boxes[2][4];       // indirect draws of boxes
  uint seen_group_count;
  uint place_count[2];    // of the two lists of places
};
layout(std430, binding = 10) buffer Places { uint places[]; };  // places in `items`; two lists
layout(std430, binding = 12) buffer SeenGroups { uint seen_groups[]; };
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

uint object_count() { return uint(bounds.length() / 2); }

/// The list of a phase that an object belongs to.
uint list_of(uint phase, uint id) {
  return 2u * phase + (one_sided(bounds[2u * id].w > 0.0, bounds[2u * id].xyz, bounds[2u * id + 1u].xyz) ? 0u : 1u);
}

/// For the next frame, and for this one unless it was drawn already.
void note_seen(uint place, uint id) {
  uint written = 1u - read_list;
  places[written * object_count() + atomicAdd(place_count[written], 1u)] = place;
  if (drawn[id] == now) return;
  uint list = list_of(1u, id);
  commands[list * object_count() + atomicAdd(command_count[list], 1u)] = templates[id];
}
)";

/// Phase one: what was seen in the last frame, from front to back: counted into buckets by distance, then placed.
inline constexpr char first_glsl[] = R"(
layout(local_size_x = GROUP) in;
layout(std430, binding = 11) buffer Buckets { uint buckets[2][256]; };
layout(location = 0) uniform int placing;  // 0: count, 1: place

/// An eighth of an octave of distance each.
uint bucket_of(uint id) {
  vec3 d = max(max(bounds[2u * id].xyz - frame.eye.xyz, frame.eye.xyz - bounds[2u * id + 1u].xyz), vec3(0.0));
  return clamp((floatBitsToUint(dot(d, d)) >> 21) - 428u, 0u, 255u);
}

void main() {
  for (uint i = gl_GlobalInvocationID.x; i < place_count[read_list]; i += gl_WorkGroupSize.x * gl_NumWorkGroups.x) {
    uint id = items[places[read_list * object_count() + i]];
    if (id >= no_candidate || outside(bounds[2u * id].xyz, bounds[2u * id + 1u].xyz)) continue;
    uint list = list_of(0u, id);
    uint place = atomicAdd(buckets[list][bucket_of(id)], 1u);
    if (placing == 0) continue;
    drawn[id] = now;
    commands[list * object_count() + place] = templates[id];
  }
}
)";

/// Between the two: where each bucket of a list begins, and how many there are in all. A workgroup for each list.
inline constexpr char buckets_glsl[] = R"(
layout(local_size_x = 256) in;
layout(std430, binding = 11) buffer Buckets { uint buckets[2][256]; };
void main() {
  uint list = gl_WorkGroupID.x, begin = 0u;
  for (uint i = 0u; i < gl_LocalInvocationID.x; ++i) begin += buckets[list][i];
  uint count = buckets[list][gl_LocalInvocationID.x];
  memoryBarrierBuffer();
  barrier();
  buckets[list][gl_LocalInvocationID.x] = begin;
  if (gl_LocalInvocationID.x == 255u) command_count[list] = begin + count;
}
)";

/// The lowest level of the pyramid: the farthest (smallest) depth of 4 x 4 pixels. Beyond the picture the edge is
/// repeated.
inline constexpr char lowest_level_glsl[] = R"(#version 450 core
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) uniform sampler2D depth;
layout(binding = 0, r32f) writeonly uniform image2D above;
void main() {
  ivec2 p = ivec2(gl_GlobalInvocationID.xy);
  vec2 pixel = 1.0 / vec2(textureSize(depth, 0)), corner = (4.0 * vec2(p) + 1.0) * pixel;
  vec4 farthest = textureGather(depth, corner);  // the four pixels around a point
  farthest = min(farthest, textureGather(depth, corner + vec2(2.0, 0.0) * pixel));
  farthest = min(farthest, textureGather(depth, corner + vec2(0.0, 2.0) * pixel));
  farthest = min(farthest, textureGather(depth, corner + vec2(2.0, 2.0) * pixel));
  imageStore(above, p, vec4(min(min(farthest.x, farthest.y), min(farthest.z, farthest.w))));
}
)";

/// Each level above: 2 x 2 of the level below. Beyond the picture it is 1, the nearest, which changes no minimum.
inline constexpr char level_glsl[] = R"(#version 450 core
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, r32f) readonly uniform image2D below;
layout(binding = 1, r32f) writeonly uniform image2D above;
void main() {
  ivec2 p = ivec2(gl_GlobalInvocationID.xy), a = 2 * p, b = min(a + 1, imageSize(below) - 1);
  float farthest = min(min(imageLoad(below, a).r, imageLoad(below, ivec2(b.x, a.y)).r),
                       min(imageLoad(below, ivec2(a.x, b.y)).r, imageLoad(below, b).r));
  imageStore(above, p, vec4(farthest));
}
)";

inline constexpr char hidden_glsl[] = R"(
layout(binding = 0) uniform sampler2D pyramid;
layout(location = 1) uniform int levels;

bool covered(ivec2 from, ivec2 to, int level, float nearest) {
  ivec2 a = from >> (level + 2), b = to >> (level + 2);
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
  int coarse = clamp(findMSB(span) - 1, 0, levels - 1);  // at most 2 x 2 texels
  if (covered(a, b, coarse, nearest)) return true;
  return coarse > 0 && covered(a, b, max(0, coarse - FINER), nearest);
}
)";

// ---- kernels are a function for each group, or for each object of the groups that were seen, and one of these two

inline constexpr char each_group_glsl[] = R"(
layout(local_size_x = GROUP) in;
void main() {
  uint g = gl_GlobalInvocationID.x;
  if (g < uint(groups.length())) visit(g, groups[g].lo.xyz, groups[g].hi.xyz);
}
)";

inline constexpr char each_object_glsl[] = R"(
layout(local_size_x = GROUP) in;
void main() {
  for (uint i = gl_WorkGroupID.x; i < seen_group_count; i += gl_NumWorkGroups.x) {
    uint g = seen_groups[i];
    if (gl_LocalInvocationID.x >= groups[g].range.y) continue;
    uint place = groups[g].range.x + gl_LocalInvocationID.x, id = items[place];
    if (id < no_candidate) visit(place, id, bounds[2u * id].xyz, bounds[2u * id + 1u].xyz);
  }
}
)";

// ---- tests against the pyramid; follow hidden_glsl

inline constexpr char test_group_glsl[] = R"(
void visit(uint g, vec3 lo, vec3 hi) {
  if (!outside(lo, hi) && !hidden(lo, hi)) seen_groups[atomicAdd(seen_group_count, 1u)] = g;
}
)";

inline constexpr char test_object_glsl[] = R"(
void visit(uint place, uint id, vec3 lo, vec3 hi) {
  if (!outside(lo, hi) && !hidden(lo, hi)) note_seen(place, id);
}
)";

// ---- boxes that write

/// Which boxes are drawn: first the groups in the frustum.
inline constexpr char group_box_glsl[] = R"(
layout(std430, binding = 9) writeonly buffer List { uint list[]; };
void visit(uint g, vec3 lo, vec3 hi) {
  if (outside(lo, hi)) return;
  if (near_or_inside(lo, hi)) seen[object_count() + g] = now;
  else list[atomicAdd(boxes[0][1], 1u)] = g;
}
)";

/// The groups that were seen become a list: invocations that have nothing to do are not free everywhere.
inline constexpr char list_seen_group_glsl[] = R"(
void visit(uint g, vec3 lo, vec3 hi) {
  if (seen[object_count() + g] == now) seen_groups[atomicAdd(seen_group_count, 1u)] = g;
}
)";

/// Then the objects of those groups.
inline constexpr char object_box_glsl[] = R"(
layout(std430, binding = 9) writeonly buffer List { uint list[]; };
void visit(uint place, uint id, vec3 lo, vec3 hi) {
  if (outside(lo, hi)) return;
  if (near_or_inside(lo, hi)) seen[id] = now;
  else list[atomicAdd(boxes[1][1], 1u)] = id;
}
)";

/// After the boxes: what is seen.
inline constexpr char note_seen_object_glsl[] = R"(
void visit(uint place, uint id, vec3 lo, vec3 hi) {
  if (seen[id] == now) note_seen(place, id);
}
)";

inline constexpr char box_vertex_glsl[] = R"(
layout(location = 0) in vec3 corner;
layout(std430, binding = 9) readonly buffer List { uint list[]; };
layout(location = 0) uniform int of_groups;
flat out uvec2 flag;  // which word, what to write
void main() {
  uint which = list[gl_InstanceID];
  vec3 lo = of_groups == 1 ? groups[which].lo.xyz : bounds[2u * which].xyz;
  vec3 hi = of_groups == 1 ? groups[which].hi.xyz : bounds[2u * which + 1u].xyz;
  flag = uvec2(of_groups == 1 ? object_count() + which : which, now);
  gl_Position = asked_corner(lo, hi, corner);
}
)";

inline constexpr char box_fragment_glsl[] = R"(#version 450 core
layout(early_fragment_tests) in;
layout(std430, binding = 4) buffer Seen { uint seen[]; };
flat in uvec2 flag;
void main() { if (seen[flag.x] != flag.y) seen[flag.x] = flag.y; }
)";

}  // namespace sightline::gl
