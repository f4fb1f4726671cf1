// OpenGL 4.5 with direct state access.
#include "gl/scene_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/type_ptr.hpp>

#include "gl/projection.hpp"
#include "gl/scene_shaders.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/scene/solid.hpp"

namespace sightline::gl {
namespace {

std::uint32_t colour_of(ObjectId id) {
  std::uint32_t x = id * 2654435761u;
  x ^= x >> 15;
  x *= 2246822519u;
  x ^= x >> 13;
  return 0xff000000u | (96u + (x & 127u)) | (96u + ((x >> 8) & 127u)) << 8 | (96u + ((x >> 16) & 127u)) << 16;
}

VertexArray make_vertex_array() {
  GLuint name = 0;
  glCreateVertexArrays(1, &name);
  return VertexArray(name);
}

void attribute(const VertexArray& array, GLuint location, GLuint binding, GLint components, GLenum type, GLuint offset,
               bool normalised = false) {
  glEnableVertexArrayAttrib(array.name(), location);
  if (type == GL_UNSIGNED_INT)
    glVertexArrayAttribIFormat(array.name(), location, components, type, offset);
  else
    glVertexArrayAttribFormat(array.name(), location, components, type, normalised ? GL_TRUE : GL_FALSE, offset);
  glVertexArrayAttribBinding(array.name(), location, binding);
}

void rows_of(const Affine& m, glm::vec4 rows[3]) {
  for (int r = 0; r < 3; ++r) rows[r] = {m[0][r], m[1][r], m[2][r], m[3][r]};
}

/// Distance of the eye from the corners of the near plane's picture, metres.
double near_corner_distance(const View& view) {
  const double aspect = static_cast<double>(view.width) / view.height;
  const double half_height =
      view.projection == Projection::perspective ? view.near * std::tan(0.5 * view.fov_y) : 0.5 * view.span_y;
  return std::hypot(view.near, half_height, half_height * aspect);
}

bool mirrors(const Affine& m) { return !(glm::determinant(glm::dmat3(m[0], m[1], m[2])) > 0.0); }

/// World bounds of a box under a map, with room for the rounding of a vertex shader.
Aabb bounds_under(const Affine& transform, const Aabb& box) {
  Aabb world;
  if (box.empty()) return world;
  for (int i = 0; i < 8; ++i) world.extend(transform_point(transform, box.corner(i)));
  const float slack = 1e-6f * reach(world);
  world.lo -= slack;
  world.hi += slack;
  return world;
}

}  // namespace

std::string SceneDrawing::frame_block() { return std::string(frame_glsl) + box_glsl; }

SceneDrawing::SceneDrawing(Context& context, const Scene& scene, const DrawingConfig& config)
    : context_(context), scene_(scene), bounds_(scene.object_bounds()) {
  upload_meshes();
  upload_objects();
  frame_buffer_ = make_buffer(sizeof(FrameBlock));
  // Software renderers interpolate between corners that were not snapped to the grid by which they cover pixels: on
  // triangles seen edge-on the depth may then be any. Hardware interpolates what it covers.
  depth_tolerance_ = context.software() ? 1.0f / 256.0f : 0.0f;
  const std::string words =
      std::string(config.lit ? "#define LIT\n" : "") + (depth_tolerance_ > 0.0f ? "#define LOOSE_DEPTH\n" : "");
  object_program_ = make_program(frame_glsl + words + object_vertex, frame_glsl + words + object_fragment);
  box_program_ = make_program(frame_block() + box_vertex, std::string("#version 450 core\n") + box_fragment);

  object_array_ = make_vertex_array();
  const GLuint a = object_array_.name();
  glVertexArrayVertexBuffer(a, 0, vertices_.name(), 0, sizeof(glm::vec3));
  glVertexArrayVertexBuffer(a, 1, transforms_.name(), 0, 3 * sizeof(glm::vec4));
  glVertexArrayVertexBuffer(a, 2, object_ids_.name(), 0, sizeof(std::uint32_t));
  glVertexArrayVertexBuffer(a, 3, colours_.name(), 0, sizeof(std::uint32_t));
  glVertexArrayElementBuffer(a, indices_.name());
  attribute(object_array_, 0, 0, 3, GL_FLOAT, 0);
  for (GLuint r = 0; r < 3; ++r) attribute(object_array_, 1 + r, 1, 4, GL_FLOAT, r * sizeof(glm::vec4));
  attribute(object_array_, 4, 2, 1, GL_UNSIGNED_INT, 0);
  attribute(object_array_, 5, 3, 4, GL_UNSIGNED_BYTE, 0, true);
  for (GLuint b = 1; b <= 3; ++b) glVertexArrayBindingDivisor(a, b, 1);

  std::vector<glm::vec3> corners;
  for (const std::uint8_t c : cube_strip) corners.emplace_back(c & 1, (c >> 1) & 1, (c >> 2) & 1);
  cube_ = make_buffer(corners);
  box_array_ = make_vertex_array();
  glVertexArrayVertexBuffer(box_array_.name(), 0, cube_.name(), 0, sizeof(glm::vec3));
  attribute(box_array_, 0, 0, 3, GL_FLOAT, 0);
  attribute(box_array_, 1, 1, 3, GL_FLOAT, 0);
  attribute(box_array_, 2, 1, 3, GL_FLOAT, sizeof(glm::vec3));
  boxes_.fill(nullptr, 0);
  glVertexArrayVertexBuffer(box_array_.name(), 1, boxes_.name(), 0, sizeof(Aabb));
  glVertexArrayBindingDivisor(box_array_.name(), 1, 1);
  context_.check("loading the scene");
}

void SceneDrawing::upload_meshes() {
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  std::vector<DrawCommand> by_mesh;
  for (const Mesh& mesh : scene_.meshes()) {
    by_mesh.push_back({static_cast<std::uint32_t>(3 * mesh.triangles.size()), 1,
                       static_cast<std::uint32_t>(3 * triangles.size()), static_cast<std::int32_t>(positions.size()),
                       0});
    positions.insert(positions.end(), mesh.positions.begin(), mesh.positions.end());
    triangles.insert(triangles.end(), mesh.triangles.begin(), mesh.triangles.end());
  }
  if (positions.size() > 0x7fffffffu || triangles.size() > 0xffffffffu / 3)
    throw Unavailable("the scene's meshes have more vertices than an OpenGL index can name");
  solid_meshes_.resize(by_mesh.size());
  parallel_blocks(by_mesh.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t m = begin; m < end; ++m)
      solid_meshes_[m] = solidity_of(scene_.meshes()[m]) == Solidity::solid ? 1 : 0;
  });
  vertices_ = make_buffer(positions);
  indices_ = make_buffer(triangles);
  for (const Object& object : scene_.objects()) {
    DrawCommand command = by_mesh[object.mesh];
    command.base_instance = static_cast<std::uint32_t>(commands_.size());
    commands_.push_back(command);
  }
}

void SceneDrawing::upload_objects() {
  const std::size_t count = scene_.objects().size();
  std::vector<glm::vec4> rows(3 * count), boxes(2 * count);
  std::vector<std::uint32_t> ids(count), colours(count), used;
  std::vector<Aabb> used_bounds;
  solid_.assign(count, 0);
  for (std::uint32_t id = 0; id < count; ++id) {
    rows_of(scene_.objects()[id].transform, &rows[3 * std::size_t{id}]);
    if (commands_[id].index_count == 0) bounds_[id] = Aabb();
    solid_[id] = solid_meshes_[scene_.objects()[id].mesh] != 0 && !mirrors(scene_.objects()[id].transform) ? 1 : 0;
    boxes[2 * std::size_t{id}] = glm::vec4(bounds_[id].lo, solid_[id]);
    boxes[2 * std::size_t{id} + 1] = glm::vec4(bounds_[id].hi, 0.0f);
    ids[id] = id;
    colours[id] = colour_of(id);
    if (bounds_[id].empty()) continue;
    used.push_back(id);
    used_bounds.push_back(bounds_[id]);
  }
  transforms_ = make_buffer(rows);
  object_ids_ = make_buffer(ids);
  colours_ = make_buffer(colours);
  bounds_buffer_ = make_buffer(boxes);
  commands_buffer_ = make_buffer(commands_);
  bvh_ = build_bvh(used_bounds, {.max_leaf_size = 1});
  for (std::uint32_t& item : bvh_.items) item = used[item];
}

void SceneDrawing::move(ObjectId id, const Affine& transform) {
  if (commands_[id].index_count == 0) return;
  glm::vec4 rows[3];
  rows_of(transform, rows);
  glNamedBufferSubData(transforms_.name(), static_cast<GLintptr>(id * sizeof rows), sizeof rows, rows);
  bounds_[id] = bounds_under(transform, scene_.mesh_of(id).bounds);
  solid_[id] = solid_meshes_[scene_.objects()[id].mesh] != 0 && !mirrors(transform) ? 1 : 0;
  const glm::vec4 box[2] = {glm::vec4(bounds_[id].lo, solid_[id]), glm::vec4(bounds_[id].hi, 0.0f)};
  glNamedBufferSubData(bounds_buffer_.name(), static_cast<GLintptr>(id * sizeof box), sizeof box, box);
  ++revision_;
}

void SceneDrawing::refit() {
  for (std::size_t n = bvh_.nodes.size(); n-- > 0;) {  // children come after their parent
    BvhNode& node = bvh_.nodes[n];
    node.bounds = Aabb();
    if (node.leaf())
      for (std::uint32_t i = 0; i < node.count; ++i) node.bounds.extend(bounds_[bvh_.items[node.first + i]]);
    else
      for (std::uint32_t i = 0; i < 2; ++i) node.bounds.extend(bvh_.nodes[node.first + i].bounds);
  }
}

void SceneDrawing::set_colours(std::span<const std::uint32_t> colours) {
  std::vector<std::uint32_t> by_id;
  if (colours.empty()) {
    for (std::uint32_t id = 0; id < commands_.size(); ++id) by_id.push_back(colour_of(id));
    colours = by_id;
  }
  glNamedBufferSubData(colours_.name(), 0,
                       static_cast<GLsizeiptr>(std::min(colours.size(), commands_.size()) * sizeof(std::uint32_t)),
                       colours.data());
}

void SceneDrawing::begin(const View& view, Target& target) {
  view_ = view;
  target_ = &target;
  target.resize(view.width, view.height);
  double farthest = glm::length(view.eye);
  if (!bvh_.nodes.empty()) farthest = std::max(farthest, static_cast<double>(reach(bvh_.nodes[0].bounds)));
  frustum_ = view_frustum(view, farthest);
  eye_ = glm::vec3(view.eye);
  forward_ = glm::vec3(view_direction(view));
  near_ = static_cast<float>(view.near);
  widening_ = static_cast<float>(std::max(pixel_size(view) / 16.0, 1e-6));
  const bool perspective = view.projection == Projection::perspective;
  FrameBlock block{};
  block.clip = glm::mat4(reversed_projection(view));
  block.eye = glm::vec4(eye_, widening_);
  for (int i = 0; i < frustum_.count; ++i) {
    const Plane& plane = frustum_.planes[static_cast<std::size_t>(i)];
    block.planes[i] = glm::vec4(plane.normal, plane.offset);
  }
  block.forward = glm::vec4(forward_, near_);
  block.size = {view.width, view.height, frustum_.count, perspective ? 1 : 0};
  near_reach_ = static_cast<float>(1.001 * near_corner_distance(view)) + 1e-6f * glm::length(eye_);
  block.depth = {depth_tolerance_, near_reach_, 0.0f, 0.0f};
  const double intercept = std::isinf(view.far) ? 0.0 : (perspective ? view.near : 1.0) / (view.far - view.near);
  block.shade =
      glm::dvec4(-pixel_size(view) * glm::dvec2(perspective, intercept), 0.5 * glm::dvec2(view.width, view.height));
  block.up = glm::vec4(glm::conjugate(view.orientation) * glm::dvec3(0.0, 1.0, 0.0), 0.0f);
  glNamedBufferSubData(frame_buffer_.name(), 0, sizeof block, &block);

  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer());
  glViewport(0, 0, view.width, view.height);
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_STENCIL_TEST);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  const GLfloat sky[] = {0.92f, 0.94f, 0.97f, 1.0f}, farthest_depth[] = {0.0f};
  const GLuint nothing[] = {no_object, 0, 0, 0};
  glClearBufferfv(GL_COLOR, 0, sky);
  glClearBufferuiv(GL_COLOR, 1, nothing);
  glClearBufferfv(GL_DEPTH, 0, farthest_depth);
  mode_ = Mode::none;
  boxes_since_draw_ = false;
  ++work_->frames;
  if (timeline_ != nullptr) timeline_->frame();
}

bool SceneDrawing::near_or_inside(const Aabb& box) const {
  const glm::vec3 half = 0.5f * box.extent(), centre = box.centre() - eye_;
  const float nearest = glm::dot(forward_, centre) - glm::dot(glm::abs(forward_), half);
  const float slack = 4.0f * (widening_ * std::max(near_, 0.0f) + 1e-6f * (reach(box) + glm::length(eye_)));
  // Boxes are widened in proportion to w, which is the distance, or 1 for orthographic views.
  const float w = view_.projection == Projection::perspective ? std::abs(nearest) : 1.0f;
  return nearest <= near_ + slack + 2.0f * widening_ * w;
}

float SceneDrawing::distance2(const Aabb& box) const {
  const glm::vec3 d = glm::max(glm::max(box.lo - eye_, eye_ - box.hi), glm::vec3(0.0f));
  return glm::dot(d, d);
}

void SceneDrawing::enter(Mode mode) {
  if (mode_ == mode) return;
  mode_ = mode;
  bind_frame();
  if (mode == Mode::boxes) {
    begin_box_mode(box_program_.name());
    mode_ = Mode::boxes;
    return;
  }
  boxes_since_draw_ = false;
  glBindVertexArray(object_array_.name());
  glUseProgram(object_program_.name());
  cull_back_faces(false);
  glCullFace(GL_BACK);
  glFrontFace(GL_CCW);
  glDisable(GL_POLYGON_OFFSET_FILL);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDepthMask(mode == Mode::objects ? GL_TRUE : GL_FALSE);
  glDepthFunc(mode == Mode::objects ? GL_GREATER : GL_EQUAL);
}

void SceneDrawing::begin_box_mode(unsigned program) {
  if (!boxes_since_draw_) ++work_->state_changes;
  boxes_since_draw_ = true;
  mode_ = Mode::none;
  bind_frame();
  glBindVertexArray(box_array_.name());
  glUseProgram(program);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  glDepthMask(GL_FALSE);
  glDepthFunc(GL_GEQUAL);
  glEnable(GL_CULL_FACE);  // the front alone decides: the eye is outside
  glCullFace(GL_BACK);
  glFrontFace(GL_CCW);
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(1.0f, 8.0f);  // towards the eye, as depth is reversed
}

void SceneDrawing::cull_back_faces(bool cull) {
  back_faces_culled_ = cull;
  if (cull)
    glEnable(GL_CULL_FACE);
  else
    glDisable(GL_CULL_FACE);
}

bool SceneDrawing::one_sided(ObjectId id) const {
  return solid_[id] != 0 && (glm::any(glm::lessThan(eye_, bounds_[id].lo - near_reach_)) ||
                             glm::any(glm::greaterThan(eye_, bounds_[id].hi + near_reach_)));
}

/// Consecutive ids of one mesh become one instanced call.
void SceneDrawing::draw_run(const ObjectId* ids, std::size_t count) {
  for (std::size_t i = 0; i < count;) {
    const DrawCommand& command = commands_[ids[i]];
    const bool cull = one_sided(ids[i]);
    std::size_t n = 1;
    while (i + n < count && ids[i + n] == ids[i] + n && commands_[ids[i + n]].first_index == command.first_index &&
           commands_[ids[i + n]].index_count == command.index_count && one_sided(ids[i + n]) == cull)
      ++n;
    if (command.index_count > 0) {
      if (cull != back_faces_culled_) cull_back_faces(cull);
      glDrawElementsInstancedBaseVertexBaseInstance(
          GL_TRIANGLES, static_cast<GLsizei>(command.index_count), GL_UNSIGNED_INT,
          reinterpret_cast<const void*>(std::size_t{4} * command.first_index), static_cast<GLsizei>(n),
          command.base_vertex, command.base_instance);
      ++work_->draw_calls;
      work_->objects += n;
      work_->triangles += n * (command.index_count / 3);
    }
    i += n;
  }
}

void SceneDrawing::draw(std::span<const ObjectId> ids) {
  if (ids.empty()) return;
  const Timeline::Guard guard(timeline_, 'D', static_cast<std::uint32_t>(ids.size()));
  enter(Mode::objects);
  draw_run(ids.data(), ids.size());
}

void SceneDrawing::draw_indirect(unsigned commands, std::size_t first, unsigned counts, std::size_t count_offset,
                                 std::uint32_t most) {
  const Timeline::Guard guard(timeline_, 'D', most);
  enter(Mode::objects);
  glBindBuffer(GL_DRAW_INDIRECT_BUFFER, commands);
  glBindBuffer(GL_PARAMETER_BUFFER_ARB, counts);
  for (std::size_t list = 0; list < 2; ++list) {
    cull_back_faces(list == 0);
    glMultiDrawElementsIndirectCountARB(GL_TRIANGLES, GL_UNSIGNED_INT,
                                        reinterpret_cast<const void*>((first + list * most) * sizeof(DrawCommand)),
                                        static_cast<GLintptr>(count_offset + list * sizeof(std::uint32_t)),
                                        static_cast<GLsizei>(most), sizeof(DrawCommand));
    ++work_->draw_calls;
  }
  // Mesa 22 takes a bound count for every later indirect draw, also for those that have none.
  glBindBuffer(GL_PARAMETER_BUFFER_ARB, 0);
}

void SceneDrawing::resolve_ties(std::span<const ObjectId> ids) {
  std::vector<ObjectId> sorted(ids.begin(), ids.end());
  std::sort(sorted.begin(), sorted.end(), std::greater<>());
  Work unused;
  Work* const counted = std::exchange(work_, &unused);
  enter(Mode::ties);
  for (const ObjectId id : sorted) draw_run(&id, 1);
  work_ = counted;
}

void SceneDrawing::begin_boxes(std::span<const Aabb> boxes) {
  boxes_.fill(boxes.data(), boxes.size_bytes());
  glVertexArrayVertexBuffer(box_array_.name(), 1, boxes_.name(), 0, sizeof(Aabb));
  enter(Mode::boxes);
}

void SceneDrawing::draw_boxes(std::uint32_t first, std::uint32_t count) {
  glDrawArraysInstancedBaseInstance(GL_TRIANGLE_STRIP, 0, 14, static_cast<GLsizei>(count), first);
  work_->query_boxes += count;
}

}  // namespace sightline::gl
