// A scene in the memory of OpenGL, and how it is drawn: objects (colour, depth, id) and boxes that only ask. Promise:
// the same objects give the same picture bit by bit in any order, once resolve_ties() has run.
// Knows no window: it draws into a Target or any framebuffer of the same kind.
#pragma once

#include <epoxy/gl.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gl/context.hpp"
#include "gl/handles.hpp"
#include "gl/target.hpp"
#include "gl/timeline.hpp"
#include "gl/work.hpp"
#include "sightline/index/bvh.hpp"
#include "sightline/scene/scene.hpp"
#include "sightline/scene/view.hpp"

namespace sightline::gl {

/// What the shaders know of an object's mesh; the layout of an indirect draw command.
struct DrawCommand {
  std::uint32_t index_count, instances, first_index;
  std::int32_t base_vertex;
  std::uint32_t base_instance;
};

struct DrawingConfig {
  bool lit = true;  // colours by object and by the way a surface faces; off: by object alone, about a third cheaper
};

/// Bindings of buffers that every program sees.
inline constexpr unsigned frame_binding = 0;

class SceneDrawing {
 public:
  /// Copies the scene into buffers. Context and scene must outlive it. Throws Unavailable if there is no memory.
  SceneDrawing(Context& context, const Scene& scene, const DrawingConfig& config = {});

  [[nodiscard]] Context& context() const { return context_; }
  [[nodiscard]] const Scene& scene() const { return scene_; }
  /// World bounds of the objects where they are now; empty for objects without triangles.
  [[nodiscard]] std::span<const Aabb> bounds() const { return bounds_; }
  /// Hierarchy over those bounds, one object in each leaf, objects without triangles left out.
  [[nodiscard]] const Bvh& bvh() const { return bvh_; }
  [[nodiscard]] std::uint32_t triangles_of(ObjectId id) const { return commands_[id].index_count / 3; }

  /// Puts an object elsewhere; refit() brings the hierarchy up to date after the last one of a frame.
  void move(ObjectId id, const Affine& transform);
  void refit();
  /// Grows with every move, so that who keeps something derived from bounds knows.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }

  /// Colours by object, 0xAABBGGRR; default, and what an empty span brings back, is a colour by id.
  void set_colours(std::span<const std::uint32_t> colours);

  /// Starts a frame: clears the target and sets the view. All that follows goes there.
  void begin(const View& view, Target& target);
  [[nodiscard]] const View& view() const { return view_; }
  [[nodiscard]] const Frustum& frustum() const { return frustum_; }
  [[nodiscard]] Target& target() const { return *target_; }
  /// True if the eye may be in the box, or the near plane may cut it: no query can answer for such a box.
  [[nodiscard]] bool near_or_inside(const Aabb& box) const;
  /// Distance of the nearest point of a box, squared; what front to back means.
  [[nodiscard]] float distance2(const Aabb& box) const;

  /// True if only the front of an object's surface is drawn: that of a solid mesh, turned no other way round, seen from
  /// outside, where the near plane opens nothing. Depends on the view and the object alone, so that pictures do not
  /// depend on who draws.
  [[nodiscard]] bool one_sided(ObjectId id) const;
  /// Draws objects in this order.
  void draw(std::span<const ObjectId> ids);
  /// Draws two lists of a buffer of DrawCommand: one-sided objects from `first` on, all others from `first + most` on;
  /// as many as the two words at `count_offset` of `counts` say.
  void draw_indirect(unsigned commands, std::size_t first, unsigned counts, std::size_t count_offset,
                     std::uint32_t most);
  /// Where objects tie in depth, the lower id wins, whatever was drawn first. Give it all objects that were drawn.
  void resolve_ties(std::span<const ObjectId> ids);

  /// From now on boxes: no colour, no depth is written, the depth test passes where a box is not behind what was drawn.
  /// Boxes are widened so that they cover each pixel centre that their content covers. `boxes` are uploaded at once.
  void begin_boxes(std::span<const Aabb> boxes);
  /// Draws the boxes [first, first + count) of the last upload.
  void draw_boxes(std::uint32_t first, std::uint32_t count);

  /// Counts go here; never null between begin() and the next begin().
  void set_work(Work* work) { work_ = work != nullptr ? work : &own_work_; }
  [[nodiscard]] Work& work() { return *work_; }
  /// Spans go here; null for none.
  void set_timeline(Timeline* timeline) { timeline_ = timeline; }
  [[nodiscard]] Timeline* timeline() const { return timeline_; }

  // Counted as state changes: switches from drawing to boxes, each of which costs about as much as the query itself.

  // For methods that run on the device: buffers by object id.
  // vec4 lo (w: 1 for solids that are not mirrored), vec4 hi
  [[nodiscard]] unsigned bounds_buffer() const { return bounds_buffer_.name(); }
  [[nodiscard]] unsigned commands_buffer() const { return commands_buffer_.name(); }  // DrawCommand
  /// GLSL: the version line, the block of the frame (clip, eye, planes ...), one_sided(), and where a box that is asked
  /// about lies.
  static std::string frame_block();
  /// Binds the frame's block for a program of the caller's.
  void bind_frame() const { glBindBufferBase(GL_UNIFORM_BUFFER, frame_binding, frame_buffer_.name()); }
  /// Leaves every mode: whoever binds programs and state of its own calls this first.
  void leave_mode() { mode_ = Mode::none; }
  /// Binds program and state of box drawing for a program of the caller's.
  void begin_box_mode(unsigned program);

 private:
  enum class Mode { none, objects, boxes, ties };
  void enter(Mode mode);
  void cull_back_faces(bool cull);
  void draw_run(const ObjectId* ids, std::size_t count);
  void upload_meshes();
  void upload_objects();

  Context& context_;
  const Scene& scene_;
  std::vector<Aabb> bounds_;
  std::vector<DrawCommand> commands_;
  std::vector<std::uint8_t> solid_meshes_, solid_;  // solid_: objects whose back faces nobody sees from outside
  Bvh bvh_;
  std::uint64_t revision_ = 0;
  Buffer vertices_, indices_, transforms_, object_ids_, colours_, bounds_buffer_, commands_buffer_, frame_buffer_;
  Buffer cube_;
  StreamBuffer boxes_;
  VertexArray object_array_, box_array_;
  Program object_program_, box_program_;
  View view_;
  Frustum frustum_;
  glm::vec3 eye_{0.0f}, forward_{0.0f};
  float near_ = 0.0f, near_reach_ = 0.0f, widening_ = 0.0f, depth_tolerance_ = 0.0f;
  Target* target_ = nullptr;
  Mode mode_ = Mode::none;
  bool boxes_since_draw_ = false, back_faces_culled_ = false;
  Work own_work_;
  Work* work_ = &own_work_;
  Timeline* timeline_ = nullptr;
};

}  // namespace sightline::gl
