#include "gl/device_culling.hpp"

#include <algorithm>
#include <string>

#include "gl/device_shaders.hpp"

namespace sightline::gl {
namespace {

constexpr std::uint32_t group_size = 64;

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
    seen_ = make_buffer((objects + groups_.size()) * sizeof(std::uint32_t));
    drawn_first_ = make_buffer(objects * sizeof(std::uint32_t));
    commands_ = make_buffer(2 * objects * sizeof(DrawCommand));
    counts_ = make_buffer(std::vector<std::uint32_t>(count_words));
    const std::string head = SceneDrawing::frame_block() + buffers_glsl;
    first_ = make_compute_program(head + first_glsl);
  }

  void drawn(std::vector<ObjectId>& ids) override {
    if (!counted_) read_drawn();
    ids = drawn_;
  }

  void reset() override { known_ = false; }

 protected:
  void render() override {
    bring_up_to_date();
    if (!known_) suppose_seen();
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

  /// Without an earlier frame the objects nearest to the eye are taken for seen, to have occluders at all.
  void suppose_seen() {
    known_ = true;
    std::vector<Placed> found;
    objects_in_frustum(drawing_, candidates(), true, found);
    std::vector<std::uint32_t> seen(object_count() + group_count());
    for (std::size_t i = 0; i < found.size() / 8; ++i) seen[found[i].id] = 1;
    glNamedBufferSubData(seen_.name(), 0, static_cast<GLsizeiptr>(seen.size() * sizeof(std::uint32_t)), seen.data());
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
  bool items_masked_ = false, counted_ = true, known_ = false;
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
    const std::string head = SceneDrawing::frame_block() + buffers_glsl;
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
