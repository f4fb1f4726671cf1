#include "gl/device_culling.hpp"

#include <algorithm>
#include <cstddef>
#include <string>

#include "gl/device_shaders.hpp"

namespace sightline::gl {
namespace {

constexpr std::uint32_t group_size = 32;
constexpr std::uint32_t most_workgroups = 256;
constexpr std::uint32_t no_buckets[2][256] = {};

struct Group {
  glm::vec4 lo, hi;
  std::uint32_t begin, count, unused[2];
};

/// As the shaders see it.
struct Counts {
  std::uint32_t commands[4] = {0, 0, 0, 0};
  std::uint32_t now = 0, read_list = 0;
  std::uint32_t boxes[2][4] = {{14, 0, 0, 0}, {14, 0, 0, 0}};  // a box is a strip of 14 corners
  std::uint32_t seen_groups = 0;
  std::uint32_t places[2] = {0, 0};
};

/// What both methods share: the buffers, and the two phases.
class DeviceCulling : public Method {
 public:
  explicit DeviceCulling(SceneDrawing& drawing) : Method(drawing) {
    if (!drawing.context().has_extension("GL_ARB_indirect_parameters"))
      throw Unavailable(
          "OpenGL has no GL_ARB_indirect_parameters, which draws as many objects as the device has counted");
    find_groups();
    const std::size_t objects = drawing.scene().objects().size();
    // Frames are numbered from 1 on, so a buffer of zeros says "never".
    seen_ = make_buffer(std::vector<std::uint32_t>(objects + groups_.size()));
    drawn_first_ = make_buffer(std::vector<std::uint32_t>(objects));
    seen_groups_ = make_buffer(groups_.size() * sizeof(std::uint32_t));
    places_ = make_buffer(2 * objects * sizeof(std::uint32_t));
    commands_ = make_buffer(4 * objects * sizeof(DrawCommand));
    counts_ = make_buffer(sizeof(Counts));
    buckets_ = make_buffer(sizeof no_buckets);
    first_ = make_kernel(first_glsl);
    begin_buckets_ = make_kernel(buckets_glsl);
  }

  void drawn(std::vector<ObjectId>& ids) override {
    if (!counted_) read_drawn();
    ids = drawn_;
  }

  void reset() override { known_ = false; }

 protected:
  void render() override {
    bring_up_to_date();
    Counts fresh;
    fresh.now = ++frame_;
    fresh.read_list = frame_ & 1;
    glNamedBufferSubData(counts_.name(), 0, offsetof(Counts, places), &fresh);
    set_place_count(1 - fresh.read_list, 0);
    if (!known_) suppose_seen(fresh.read_list);
    bind();
    list_first();
    drawing_.draw_indirect(commands_.name(), 0, counts_.name(), 0, object_count());
    drawing_.leave_mode();
    {
      const Timeline::Guard guard(drawing_.timeline(), 'Q', object_count());
      test();
    }
    ++drawing_.work().state_changes;
    drawing_.work().queries += object_count();
    glMemoryBarrier(GL_COMMAND_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
    drawing_.draw_indirect(commands_.name(), 2 * std::size_t{object_count()}, counts_.name(), 2 * sizeof(std::uint32_t),
                           object_count());
    counted_ = false;
  }

  /// Notes for the next frame what is seen, and lists what of it was not yet drawn.
  virtual void test() = 0;

  void bind() {
    const unsigned names[] = {
        drawing_.bounds_buffer(), groups_buffer_.name(),      items_buffer_.name(), seen_.name(),
        drawn_first_.name(),      drawing_.commands_buffer(), commands_.name(),     counts_.name()};
    for (GLuint i = 0; i < 8; ++i) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, i + 1, names[i]);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 10, places_.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 12, seen_groups_.name());
    drawing_.bind_frame();
  }

  /// What was seen in the last frame becomes the first list.
  void list_first() {
    glNamedBufferSubData(buckets_.name(), 0, sizeof no_buckets, no_buckets);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 11, buckets_.name());
    glProgramUniform1i(first_.name(), 0, 0);
    run_for_objects(first_);
    run(begin_buckets_, 2);
    glProgramUniform1i(first_.name(), 0, 1);
    run_for_objects(first_);
  }

  /// A program of a compute shader that sees all buffers.
  static Program make_kernel(std::string source) {
    source = SceneDrawing::frame_block() + buffers_glsl + source;
    if (const std::size_t at = source.find("GROUP"); at != std::string::npos)
      source.replace(at, 5, std::to_string(group_size));
    return make_compute_program(source);
  }

  static void run(const Program& program, std::uint32_t workgroups) {
    glUseProgram(program.name());
    glDispatchCompute(workgroups, 1, 1);
    glMemoryBarrier(GL_COMMAND_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
  }
  /// An invocation for each group.
  void run_for_groups(const Program& program) { run(program, (group_count() + group_size - 1) / group_size); }
  /// Workgroups that share the groups that were seen, an invocation for each object of one.
  void run_for_objects(const Program& program) { run(program, std::min(most_workgroups, group_count())); }
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

  void set_place_count(std::uint32_t list, std::uint32_t count) {
    glNamedBufferSubData(counts_.name(), static_cast<GLintptr>(offsetof(Counts, places) + list * sizeof count),
                         sizeof count, &count);
  }

  /// Without an earlier frame the objects nearest to the eye are taken for seen, to have occluders at all.
  void suppose_seen(std::uint32_t list) {
    known_ = true;
    std::vector<Placed> found;
    objects_in_frustum(drawing_, candidates(), true, found);
    std::vector<std::uint32_t> place_of(object_count()), near;
    for (std::uint32_t place = 0; place < items_.size(); ++place) place_of[drawing_.bvh().items[place]] = place;
    for (std::size_t i = 0; i < found.size() / 8; ++i) near.push_back(place_of[found[i].id]);
    set_place_count(list, static_cast<std::uint32_t>(near.size()));
    glNamedBufferSubData(places_.name(), static_cast<GLintptr>(list * object_count() * sizeof(std::uint32_t)),
                         static_cast<GLsizeiptr>(near.size() * sizeof(std::uint32_t)), near.data());
  }

  /// What the frame drew, read after it.
  void read_drawn() {
    counted_ = true;
    drawn_.clear();
    std::uint32_t counts[4];
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(counts_.name(), 0, sizeof counts, counts);
    std::vector<DrawCommand> commands;
    for (std::uint32_t list = 0; list < 4; ++list) {
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
  std::uint32_t frame_ = 0;
  bool items_masked_ = false, counted_ = true, known_ = false;
  Buffer groups_buffer_, items_buffer_, seen_, drawn_first_, seen_groups_, places_, commands_, counts_, buckets_;
  Program first_, begin_buckets_;
};

class Hzb final : public DeviceCulling {
 public:
  Hzb(SceneDrawing& drawing, int finer) : DeviceCulling(drawing) {
    std::string hidden = hidden_glsl;
    hidden.replace(hidden.find("FINER"), 5, std::to_string(finer));
    of_groups_ = make_kernel(hidden + test_group_glsl + each_group_glsl);
    of_objects_ = make_kernel(hidden + test_object_glsl + each_object_glsl);
    lowest_level_ = make_compute_program(lowest_level_glsl);
    next_level_ = make_compute_program(level_glsl);
  }

 private:
  void test() override {
    build_pyramid();
    bind();
    glBindTextureUnit(0, pyramid_.name());
    for (const Program* program : {&of_groups_, &of_objects_}) glProgramUniform1i(program->name(), 1, levels_);
    run_for_groups(of_groups_);
    run_for_objects(of_objects_);
  }

  void build_pyramid() {
    const int width = (drawing_.target().width() + 3) / 4, height = (drawing_.target().height() + 3) / 4;
    if (!pyramid_ || width != width_ || height != height_) make_pyramid(width, height);
    for (int level = 0; level < levels_; ++level) {
      glUseProgram((level == 0 ? lowest_level_ : next_level_).name());
      if (level == 0)
        glBindTextureUnit(0, drawing_.target().depth_texture());
      else
        glBindImageTexture(0, pyramid_.name(), level - 1, GL_FALSE, 0, GL_READ_ONLY, GL_R32F);
      glBindImageTexture(level == 0 ? 0 : 1, pyramid_.name(), level, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
      const int w = ((width - 1) >> level) + 1, h = ((height - 1) >> level) + 1;
      glDispatchCompute(static_cast<GLuint>(w + 7) / 8, static_cast<GLuint>(h + 7) / 8, 1);
      glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    }
  }

  /// Sizes that round down would lose the last row: the pyramid has power-of-two sides.
  void make_pyramid(int width, int height) {
    width_ = width;
    height_ = height;
    GLsizei side_x = 1, side_y = 1;
    while (side_x < width) side_x *= 2;
    while (side_y < height) side_y *= 2;
    levels_ = 1;
    while ((std::max(side_x, side_y) >> levels_) > 0) ++levels_;
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &name);
    pyramid_ = Texture(name);
    glTextureStorage2D(name, levels_, GL_R32F, side_x, side_y);
    glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST_MIPMAP_NEAREST);
    glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    const float nearest = 1.0f;
    for (int level = 0; level < levels_; ++level) glClearTexImage(name, level, GL_RED, GL_FLOAT, &nearest);
  }

  Program of_groups_, of_objects_;
  Program lowest_level_, next_level_;
  Texture pyramid_;
  int width_ = 0, height_ = 0, levels_ = 1;
};

class Raster final : public DeviceCulling {
 public:
  explicit Raster(SceneDrawing& drawing) : DeviceCulling(drawing) {
    group_boxes_ = make_kernel(std::string(group_box_glsl) + each_group_glsl);
    list_groups_ = make_kernel(std::string(list_seen_group_glsl) + each_group_glsl);
    object_boxes_ = make_kernel(std::string(object_box_glsl) + each_object_glsl);
    newly_ = make_kernel(std::string(note_seen_object_glsl) + each_object_glsl);
    draw_boxes_ = make_program(SceneDrawing::frame_block() + buffers_glsl + box_vertex_glsl, box_fragment_glsl);
    list_ = make_buffer(std::max<std::size_t>(object_count(), group_count()) * sizeof(std::uint32_t));
  }

 private:
  void test() override {
    bind();
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 9, list_.name());
    run_for_groups(group_boxes_);
    draw_listed(true);
    run_for_groups(list_groups_);
    run_for_objects(object_boxes_);
    draw_listed(false);
    run_for_objects(newly_);
  }

  /// Draws the boxes that the device has listed; their fragments write.
  void draw_listed(bool groups) {
    drawing_.begin_box_mode(draw_boxes_.name());
    glUniform1i(0, groups ? 1 : 0);
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, counts());
    const std::size_t command = offsetof(Counts, boxes) + (groups ? 0 : sizeof(Counts::boxes[0]));
    glDrawArraysIndirect(GL_TRIANGLE_STRIP, reinterpret_cast<const void*>(command));
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  }

  Program group_boxes_, list_groups_, object_boxes_, newly_, draw_boxes_;
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
