#include "gl/device_culling.hpp"

#include <algorithm>
#include <string>

namespace sightline::gl {
namespace {

constexpr std::uint32_t group_size = 64;

/// Buffers that all kernels see. A group is a subtree of the hierarchy with at most 64 objects, which lie side by side
/// in `items`; the highest bit of an item says that it is no candidate.
constexpr char buffers_glsl[] = R"(
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

float widening_of(vec3 lo, vec3 hi) {
  vec3 reach = max(abs(lo), abs(hi));
  return 1e-6 * max(reach.x, max(reach.y, reach.z));
}

/// The eye may be in the box, or the near plane may cut it.
bool near_or_inside(vec3 lo, vec3 hi) {
  vec3 half_extent = 0.5 * (hi - lo), centre = 0.5 * (lo + hi) - frame.eye.xyz;
  float nearest = dot(frame.forward.xyz, centre) - dot(abs(frame.forward.xyz), half_extent);
  float slack = 4.0 * (frame.eye.w * frame.forward.w + widening_of(lo, hi) + 1e-6 * length(frame.eye.xyz));
  return nearest <= frame.forward.w + slack + frame.eye.w * abs(nearest);
}

void append(uint list, uint id) {
  uint place = atomicAdd(counts[list], 1u);
  commands[list * uint(bounds.length() / 2) + place] = templates[id];
}
)";

/// Phase one: what was seen in the last frame.
constexpr char first_glsl[] = R"(
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
constexpr char pyramid_glsl[] = R"(
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

constexpr char hidden_glsl[] = R"(
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
  float extra = widening_of(lo, hi), nearest = 0.0;
  vec2 from = vec2(1e30), to = vec2(-1e30);
  mat4 clip = frame.clip;
  for (int i = 0; i < 8; ++i) {
    vec3 corner = vec3(i & 1, (i >> 1) & 1, (i >> 2) & 1);
    vec3 p = mix(lo, hi, corner) - frame.eye.xyz;
    float w = dot(vec4(clip[0].w, clip[1].w, clip[2].w, clip[3].w), vec4(p, 1.0));
    vec4 q = clip * vec4(p + (2.0 * corner - 1.0) * (frame.eye.w * abs(w) + extra), 1.0);
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
constexpr char second_glsl[] = R"(
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
constexpr char boxes_glsl[] = R"(
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

constexpr char box_vertex_glsl[] = R"(
layout(location = 0) in vec3 corner;
layout(std430, binding = 9) readonly buffer List { uint list[]; };
layout(location = 0) uniform int mode;
flat out uint flag;
void main() {
  uint which = list[gl_InstanceID];
  vec3 lo = mode == 0 ? groups[which].lo.xyz : bounds[2u * which].xyz;
  vec3 hi = mode == 0 ? groups[which].hi.xyz : bounds[2u * which + 1u].xyz;
  flag = mode == 0 ? uint(bounds.length() / 2) + which : which;
  vec3 p = mix(lo, hi, corner) - frame.eye.xyz;
  float w = (frame.clip * vec4(p, 1.0)).w;
  float wide = frame.eye.w * abs(w) + widening_of(lo, hi);
  gl_Position = frame.clip * vec4(p + (2.0 * corner - 1.0) * wide, 1.0);
}
)";

constexpr char box_fragment_glsl[] = R"(#version 450 core
layout(early_fragment_tests) in;
layout(std430, binding = 4) buffer Seen { uint seen[]; };
flat in uint flag;
void main() { if (seen[flag] == 0u) seen[flag] = 1u; }
)";

/// After the boxes: what is seen and not yet drawn.
constexpr char newly_glsl[] = R"(
layout(local_size_x = 64) in;
void main() {
  Group group = groups[gl_WorkGroupID.x];
  if (gl_LocalInvocationID.x >= group.range.y) return;
  uint id = items[group.range.x + gl_LocalInvocationID.x] & ~no_candidate;
  if (seen[id] != 0u && drawn[id] == 0u) append(1u, id);
}
)";

struct Group {
  glm::vec4 lo, hi;
  std::uint32_t begin, count, unused[2];
};

constexpr std::uint32_t count_words = 16;

/// What both methods share: the buffers, and the two phases.
class DeviceCulling : public Method {
 public:
  explicit DeviceCulling(SceneDrawing& drawing) : Method(drawing) {
    if (!drawing.context().has_extension("GL_ARB_indirect_parameters"))
      throw Unavailable(
          "OpenGL has no GL_ARB_indirect_parameters, which draws as many objects as the device has counted");
    find_groups();
    const std::size_t objects = drawing.scene().objects().size();
    seen_ = make_buffer(std::vector<std::uint32_t>(objects + groups_.size()));
    drawn_first_ = make_buffer(objects * sizeof(std::uint32_t));
    commands_ = make_buffer(2 * objects * sizeof(DrawCommand));
    counts_ = make_buffer(std::vector<std::uint32_t>(count_words));
    const std::string head = std::string(SceneDrawing::frame_block()) + buffers_glsl;
    first_ = make_compute_program(head + first_glsl);
  }

  void drawn(std::vector<ObjectId>& ids) override {
    if (!counted_) read_drawn();
    ids = drawn_;
  }

  void reset() override {
    const std::vector<std::uint32_t> nothing(drawing_.scene().objects().size() + groups_.size());
    glNamedBufferSubData(seen_.name(), 0, static_cast<GLsizeiptr>(nothing.size() * sizeof(std::uint32_t)),
                         nothing.data());
  }

 protected:
  void render() override {
    bring_up_to_date();
    const std::uint32_t zero[count_words] = {0, 0, 0, 0, 14, 0, 0, 0, 14};  // two indirect draws of a strip of 14
    glNamedBufferSubData(counts_.name(), 0, sizeof zero, zero);
    bind();
    glUseProgram(first_.name());
    run(group_count());
    glMemoryBarrier(GL_COMMAND_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
    drawing_.draw_indirect(commands_.name(), 0, counts_.name(), 0, object_count());
    drawing_.leave_mode();
    {
      const Timeline::Guard guard(drawing_.timeline(), 'Q', object_count());
      test();
    }
    ++drawing_.work().state_changes;
    drawing_.work().queries += object_count();
    glMemoryBarrier(GL_COMMAND_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
    drawing_.draw_indirect(commands_.name(), object_count(), counts_.name(), sizeof(std::uint32_t), object_count());
    counted_ = false;
  }

  /// Fills `seen_` and the second list.
  virtual void test() = 0;

  void bind() {
    const unsigned names[] = {
        drawing_.bounds_buffer(), groups_buffer_.name(),      items_buffer_.name(), seen_.name(),
        drawn_first_.name(),      drawing_.commands_buffer(), commands_.name(),     counts_.name()};
    for (GLuint i = 0; i < 8; ++i) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, i + 1, names[i]);
    drawing_.bind_frame();
  }

  static void run(std::uint32_t groups) { glDispatchCompute(groups, 1, 1); }
  [[nodiscard]] std::uint32_t group_count() const { return static_cast<std::uint32_t>(groups_.size()); }
  [[nodiscard]] std::uint32_t object_count() const {
    return static_cast<std::uint32_t>(drawing_.scene().objects().size());
  }
  [[nodiscard]] unsigned counts() const { return counts_.name(); }

 private:
  void find_groups() {
    const Bvh& bvh = drawing_.bvh();
    nodes_.clear();
    groups_.clear();
    std::vector<std::uint32_t> stack;
    if (!bvh.nodes.empty()) stack.push_back(0);
    while (!stack.empty()) {
      const std::uint32_t n = stack.back();
      stack.pop_back();
      const ItemRange range = items_below(bvh, n);
      if (range.end - range.begin > group_size) {
        stack.push_back(bvh.nodes[n].first + 1);
        stack.push_back(bvh.nodes[n].first);
        continue;
      }
      nodes_.push_back(n);
      groups_.push_back({{}, {}, range.begin, range.end - range.begin, {}});
    }
    groups_buffer_ = make_buffer(groups_.size() * sizeof(Group));
    items_ = bvh.items;
    items_buffer_ = make_buffer(items_);
    revision_ = drawing_.revision() + 1;  // never equal: the bounds are still missing
  }

  void bring_up_to_date() {
    if (revision_ != drawing_.revision()) {
      for (std::size_t g = 0; g < groups_.size(); ++g) {
        groups_[g].lo = glm::vec4(drawing_.bvh().nodes[nodes_[g]].bounds.lo, 0.0f);
        groups_[g].hi = glm::vec4(drawing_.bvh().nodes[nodes_[g]].bounds.hi, 0.0f);
      }
      glNamedBufferSubData(groups_buffer_.name(), 0, static_cast<GLsizeiptr>(groups_.size() * sizeof(Group)),
                           groups_.data());
      revision_ = drawing_.revision();
    }
    if (candidates() == nullptr && !items_masked_) return;
    for (std::size_t i = 0; i < items_.size(); ++i) {
      const ObjectId id = drawing_.bvh().items[i];
      items_[i] = is_candidate(id) ? id : id | 0x80000000u;
    }
    items_masked_ = candidates() != nullptr;
    glNamedBufferSubData(items_buffer_.name(), 0, static_cast<GLsizeiptr>(items_.size() * sizeof(std::uint32_t)),
                         items_.data());
  }

  /// What the frame drew, read after it.
  void read_drawn() {
    counted_ = true;
    drawn_.clear();
    std::uint32_t counts[2];
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(counts_.name(), 0, sizeof counts, counts);
    std::vector<DrawCommand> commands;
    for (std::uint32_t list = 0; list < 2; ++list) {
      commands.resize(counts[list]);
      if (commands.empty()) continue;
      glGetNamedBufferSubData(commands_.name(), static_cast<GLintptr>(list * object_count() * sizeof(DrawCommand)),
                              static_cast<GLsizeiptr>(commands.size() * sizeof(DrawCommand)), commands.data());
      for (const DrawCommand& command : commands) {
        drawn_.push_back(command.base_instance);
        ++drawing_.work().objects;
        drawing_.work().triangles += command.index_count / 3;
      }
    }
  }

  std::vector<std::uint32_t> nodes_, items_;
  std::vector<Group> groups_;
  std::uint64_t revision_ = 0;
  bool items_masked_ = false, counted_ = true;
  Buffer groups_buffer_, items_buffer_, seen_, drawn_first_, commands_, counts_;
  Program first_;
};

class Hzb final : public DeviceCulling {
 public:
  Hzb(SceneDrawing& drawing, int finer) : DeviceCulling(drawing) {
    const std::string head = SceneDrawing::frame_block();
    std::string hidden = hidden_glsl;
    hidden.replace(hidden.find("FINER"), 5, std::to_string(finer));
    second_ = make_compute_program(head + buffers_glsl + hidden + second_glsl);
    pyramid_program_ = make_compute_program(std::string("#version 450 core\n") + pyramid_glsl);
  }

 private:
  void test() override {
    build_pyramid();
    bind();
    glUseProgram(second_.name());
    glBindTextureUnit(0, pyramid_.name());
    glUniform1i(1, levels_);
    run(group_count());
  }

  void build_pyramid() {
    const int width = (drawing_.target().width() + 1) / 2, height = (drawing_.target().height() + 1) / 2;
    if (!pyramid_ || width != width_ || height != height_) {
      GLuint name = 0;
      glCreateTextures(GL_TEXTURE_2D, 1, &name);
      pyramid_ = Texture(name);
      width_ = width;
      height_ = height;
      // Sizes that round down would lose the last row: the pyramid has power-of-two sides.
      side_x_ = side_y_ = 1;
      while (side_x_ < width) side_x_ *= 2;
      while (side_y_ < height) side_y_ *= 2;
      levels_ = 1;
      while ((std::max(side_x_, side_y_) >> levels_) > 0) ++levels_;
      glTextureStorage2D(name, levels_, GL_R32F, side_x_, side_y_);
      glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST_MIPMAP_NEAREST);
      glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    }
    glUseProgram(pyramid_program_.name());
    for (int level = 0; level < levels_; ++level) {
      glBindTextureUnit(0, level == 0 ? drawing_.target().depth_texture() : pyramid_.name());
      glBindImageTexture(0, pyramid_.name(), level, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
      glUniform1i(0, std::max(0, level - 1));
      if (level == 0)
        glUniform2i(1, drawing_.target().width() - 1, drawing_.target().height() - 1);
      else
        glUniform2i(1, (width_ - 1) >> (level - 1), (height_ - 1) >> (level - 1));
      const int w = ((width_ - 1) >> level) + 1, h = ((height_ - 1) >> level) + 1;
      glDispatchCompute(static_cast<GLuint>(w + 7) / 8, static_cast<GLuint>(h + 7) / 8, 1);
      glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    }
  }

  Program second_, pyramid_program_;
  Texture pyramid_;
  int width_ = 0, height_ = 0, side_x_ = 1, side_y_ = 1, levels_ = 1;
};

class Raster final : public DeviceCulling {
 public:
  explicit Raster(SceneDrawing& drawing) : DeviceCulling(drawing) {
    const std::string head = std::string(SceneDrawing::frame_block()) + buffers_glsl;
    boxes_ = make_compute_program(head + boxes_glsl);
    newly_ = make_compute_program(head + newly_glsl);
    draw_boxes_ = make_program(head + box_vertex_glsl, box_fragment_glsl);
    list_ = make_buffer(std::max<std::size_t>(object_count(), group_count()) * sizeof(std::uint32_t));
  }

 private:
  void test() override {
    for (const int mode : {0, 1}) {  // groups, then the objects of those that are seen
      bind();
      glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 9, list_.name());
      glUseProgram(boxes_.name());
      glUniform1i(0, mode);
      glUniform1ui(1, group_count());
      run(mode == 0 ? (group_count() + group_size - 1) / group_size : group_count());
      glMemoryBarrier(GL_COMMAND_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
      drawing_.begin_box_mode(draw_boxes_.name());
      glUniform1i(0, mode);
      glBindBuffer(GL_DRAW_INDIRECT_BUFFER, counts());
      glDrawArraysIndirect(GL_TRIANGLE_STRIP,
                           reinterpret_cast<const void*>((mode == 0 ? 4 : 8) * sizeof(std::uint32_t)));
      glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    }
    bind();
    glUseProgram(newly_.name());
    run(group_count());
  }

  Program boxes_, newly_, draw_boxes_;
  Buffer list_;
};

}  // namespace

std::unique_ptr<Method> make_hzb(SceneDrawing& drawing, ParameterReader& parameters) {
  int finer = 2;
  parameters.read("finer", finer, 0, 4);
  parameters.finish();
  return std::make_unique<Hzb>(drawing, finer);
}

std::unique_ptr<Method> make_raster(SceneDrawing& drawing, ParameterReader& parameters) {
  parameters.finish();
  return std::make_unique<Raster>(drawing);
}

}  // namespace sightline::gl
