// The C interface of the occlusion buffer.
#include <new>

#include "sightline/raster/occlusion_buffer.h"
#include "sightline/raster/occlusion_buffer.hpp"
#include "sightline/scene/input_error.hpp"

struct sightline_occlusion_buffer {
  sightline::OcclusionBuffer buffer;
};
struct sightline_occluder {
  sightline::OccluderMesh mesh;
};

namespace {

using namespace sightline;

static_assert(sizeof(glm::vec3) == 3 * sizeof(float) && sizeof(glm::uvec3) == 3 * sizeof(std::uint32_t));
static_assert(sizeof(Aabb) == 6 * sizeof(float));

glm::vec3 vector(const float* v) { return {v[0], v[1], v[2]}; }

Affine affine(const float* m) {
  if (m == nullptr) return identity_affine();
  return {vector(m), vector(m + 3), vector(m + 6), vector(m + 9)};
}

std::span<const glm::vec3> points(const float* positions, std::size_t count) {
  return {reinterpret_cast<const glm::vec3*>(positions), count};
}

std::span<const glm::uvec3> faces(const std::uint32_t* triangles, std::size_t count) {
  return {reinterpret_cast<const glm::uvec3*>(triangles), count};
}

bool indices_within(const std::uint32_t* triangles, std::size_t triangle_count, std::size_t position_count) {
  for (std::size_t i = 0; i < 3 * triangle_count; ++i)
    if (triangles[i] >= position_count) return false;
  return true;
}

/// Runs body and turns exceptions into a code.
template <class Body>
int guarded(Body&& body) {
  try {
    body();
    return SIGHTLINE_OK;
  } catch (const InputError&) {
    return SIGHTLINE_BAD_INPUT;
  } catch (...) {
    return SIGHTLINE_NO_MEMORY;
  }
}

View to_view(const sightline_occlusion_view& v) {
  View view = look_along({v.eye[0], v.eye[1], v.eye[2]}, {v.direction[0], v.direction[1], v.direction[2]},
                         {v.up[0], v.up[1], v.up[2]});
  view.projection = v.fov_y > 0.0 ? Projection::perspective : Projection::orthographic;
  if (v.fov_y > 0.0) view.fov_y = v.fov_y;
  view.span_y = v.span_y;
  view.near = v.near_plane;
  view.far = 2.0 * v.near_plane + 1.0;  // not used by the buffer
  view.width = v.view_width;
  view.height = v.view_height;
  check_view(view);
  return view;
}

}  // namespace

sightline_occlusion_buffer* sightline_occlusion_buffer_create() {
  sightline_occlusion_buffer* buffer = nullptr;
  guarded([&] { buffer = new sightline_occlusion_buffer; });
  return buffer;
}

void sightline_occlusion_buffer_destroy(sightline_occlusion_buffer* buffer) { delete buffer; }

sightline_occluder* sightline_occluder_create(const float* positions, std::size_t position_count,
                                              const std::uint32_t* triangles, std::size_t triangle_count) {
  if (!indices_within(triangles, triangle_count, position_count)) return nullptr;
  sightline_occluder* occluder = nullptr;
  guarded([&] {
    occluder =
        new sightline_occluder{make_occluder(points(positions, position_count), faces(triangles, triangle_count))};
  });
  return occluder;
}

void sightline_occluder_destroy(sightline_occluder* occluder) { delete occluder; }

int sightline_occlusion_begin(sightline_occlusion_buffer* buffer, const sightline_occlusion_view* view) {
  return guarded([&] {
    const int width = view->buffer_width, height = view->buffer_height;
    const bool centres = view->centres != 0;
    if (width < 1 || height < 1 || width > 16384 || height > 16384)
      throw InputError("the buffer must be 1 to 16384 pixels wide and high");
    const View of = to_view(*view);
    if (centres && (width % of.width != 0 || height % of.height != 0 || width / of.width != height / of.height))
      throw InputError("pixel centres alone count only in a buffer of the view's size or a whole multiple of it");
    buffer->buffer.begin(of, width, height, centres ? Coverage::centres : Coverage::squares);
  });
}

int sightline_occlusion_add(sightline_occlusion_buffer* buffer, const sightline_occluder* occluder,
                            const float* transform) {
  return guarded([&] { buffer->buffer.add_occluder(occluder->mesh, affine(transform)); });
}

int sightline_occlusion_add_triangles(sightline_occlusion_buffer* buffer, const float* positions,
                                      std::size_t position_count, const std::uint32_t* triangles,
                                      std::size_t triangle_count, const float* transform) {
  if (!indices_within(triangles, triangle_count, position_count)) return SIGHTLINE_BAD_INPUT;
  return guarded([&] {
    buffer->buffer.add_occluder(points(positions, position_count), faces(triangles, triangle_count), affine(transform));
  });
}

int sightline_occlusion_box(const sightline_occlusion_buffer* buffer, const float* lo, const float* hi) {
  return buffer->buffer.may_be_seen(Aabb{vector(lo), vector(hi)}) ? 1 : 0;
}

int sightline_occlusion_oriented_box(const sightline_occlusion_buffer* buffer, const float* transform, const float* lo,
                                     const float* hi) {
  return buffer->buffer.may_be_seen(OrientedBox{affine(transform), {vector(lo), vector(hi)}}) ? 1 : 0;
}

int sightline_occlusion_sphere(const sightline_occlusion_buffer* buffer, const float* centre, float radius) {
  return buffer->buffer.may_be_seen(Sphere{vector(centre), radius}) ? 1 : 0;
}

int sightline_occlusion_triangle(const sightline_occlusion_buffer* buffer, const float* a, const float* b,
                                 const float* c) {
  return buffer->buffer.may_be_seen(vector(a), vector(b), vector(c)) ? 1 : 0;
}

int sightline_occlusion_boxes(const sightline_occlusion_buffer* buffer, const float* boxes, std::size_t count,
                              std::uint8_t* seen) {
  return guarded([&] { buffer->buffer.test({reinterpret_cast<const Aabb*>(boxes), count}, {seen, count}); });
}
