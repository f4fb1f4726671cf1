#include "sightline/raster/occlusion_buffer.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "sightline/raster/occlusion_clip.hpp"
#include "sightline/raster/occlusion_kernels.hpp"

namespace sightline {
namespace {

using raster::Kernels;
using raster::Margins;
using raster::ScreenTransform;

constexpr double base_margin = 1.0 / 64;  // pixels: rounding of projected corners and edge functions
constexpr double base_share = 0x1p-16;    // relative: rounding of nearness in perspective
constexpr double base_spread = 0x1p-20;   // of the distance from the eye: rounding of nearness in orthographic views
constexpr double float_guard = 8192;      // pixels from the image's centre within which floats keep base_margin

/// Where a box lies: distances along the view direction, and its projection in pixels if all of it lies before the eye.
struct Footprint {
  double nearest, farthest;
  double x0, y0, x1, y1;
  double spread;  // of its corners from the eye
};

}  // namespace

namespace {

glm::dvec3 to_row(const glm::dmat3& m, int row) { return {m[0][row], m[1][row], m[2][row]}; }

}  // namespace

struct OcclusionBuffer::State {
  const Kernels* kernels;
  raster::Tiles tiles;
  raster::Scratch scratch;
  OcclusionCounts counts;
  // The view: rows turn world - eye into pixels from the centre (times distance, for perspective) and into distance.
  glm::dvec3 eye{0.0}, to_x{0.0}, to_y{0.0}, to_w{0.0};
  double centre_x = 0, centre_y = 0, near = 0, pixels_per_unit = 1;
  bool perspective = true;

  [[nodiscard]] Footprint footprint(const Aabb& box) const {
    Footprint f{1e300, -1e300, 1e300, 1e300, -1e300, -1e300, 0};
    for (int i = 0; i < 8; ++i) {
      const glm::dvec3 d = glm::dvec3(box.corner(i)) - eye;
      const double w = glm::dot(to_w, d);
      f.nearest = std::min(f.nearest, w);
      f.farthest = std::max(f.farthest, w);
      const double scale = perspective ? 1.0 / w : 1.0;  // meaningless unless nearest > 0; the caller checks
      const double x = centre_x + glm::dot(to_x, d) * scale, y = centre_y + glm::dot(to_y, d) * scale;
      f.x0 = std::min(f.x0, x);
      f.x1 = std::max(f.x1, x);
      f.y0 = std::min(f.y0, y);
      f.y1 = std::max(f.y1, y);
      f.spread = std::max(f.spread, glm::dot(d, d));
    }
    f.spread = std::sqrt(f.spread);
    return f;
  }

  /// True if the float loops keep base_margin and base_share (or base_spread) for all of a mesh: it lies before the
  /// eye, not too far aside, and the products that make up a corner are not much larger than the corner (a squashed
  /// mesh).
  [[nodiscard]] bool within_guard(const Footprint& f, const OccluderMesh& mesh, const glm::dmat3& rows,
                                  const glm::dvec3& mesh_eye) const {
    const double aside = std::max({centre_x - f.x0, f.x1 - centre_x, centre_y - f.y0, f.y1 - centre_y});
    if (!(f.nearest > near && aside < float_guard)) return false;
    glm::dvec3 largest(0.0);  // of the sums of the products' sizes for x, y and distance, per unit of distance
    for (int i = 0; i < 8; ++i) {
      const glm::dvec3 d = glm::dvec3(mesh.bounds.corner(i)) - mesh_eye;
      const double w = perspective ? glm::dot(to_row(rows, 2), d) : 1.0;
      for (int row = 0; row < 3; ++row)
        largest[row] = std::max(largest[row], glm::dot(glm::abs(to_row(rows, row)), glm::abs(d)) / w);
    }
    // Four roundings of each product and sum.
    const double pixels = 0x1p-22 * (std::max(largest.x, largest.y) + (perspective ? aside * largest.z : 0.0));
    const double nearness = 0x1p-22 * largest.z;
    return pixels < 0.5 * base_margin && nearness < (perspective ? 0.5 * base_share : 0.5 * base_spread * f.spread);
  }

  [[nodiscard]] Margins margins(const Footprint& f, const OccluderMesh& mesh, const Affine& transform) const {
    // The truth has its vertices rounded to float in world space; an identity transform rounds nothing.
    double rounding = 0.0;
    if (transform != identity_affine()) {
      const glm::vec3 size = glm::max(glm::abs(mesh.bounds.lo), glm::abs(mesh.bounds.hi));
      const glm::vec3 terms = glm::abs(transform[0]) * size.x + glm::abs(transform[1]) * size.y +
                              glm::abs(transform[2]) * size.z + glm::abs(transform[3]);
      rounding = 0x1p-21 * static_cast<double>(std::max({terms.x, terms.y, terms.z}));
    }
    if (!perspective)
      return {static_cast<float>(base_margin + rounding * pixels_per_unit), 0.0f,
              static_cast<float>(base_spread * f.spread + rounding)};
    const double nearest = std::max(f.nearest, near);
    return {static_cast<float>(base_margin + rounding * pixels_per_unit / nearest),
            static_cast<float>(base_share + rounding / nearest), 0.0f};
  }

  [[nodiscard]] bool outside_image(const Footprint& f) const {
    if (f.farthest < near) return true;
    if (f.nearest <= near) return false;
    return f.x1 < -1 || f.y1 < -1 || f.x0 > tiles.width + 1 || f.y0 > tiles.height + 1;
  }
};

OcclusionBuffer::OcclusionBuffer(bool scalar) : state_(std::make_unique<State>()) {
  state_->kernels = scalar ? &raster::scalar_kernels() : &raster::simd_kernels();
}
OcclusionBuffer::~OcclusionBuffer() = default;
OcclusionBuffer::OcclusionBuffer(OcclusionBuffer&&) noexcept = default;
OcclusionBuffer& OcclusionBuffer::operator=(OcclusionBuffer&&) noexcept = default;

void OcclusionBuffer::begin(const View& view, int width, int height) {
  assert(width >= 1 && height >= 1);
  State& s = *state_;
  s.tiles.resize(width, height);
  s.counts = {};
  s.perspective = view.projection == Projection::perspective;
  s.eye = view.eye;
  s.near = view.near;
  s.centre_x = 0.5 * width;
  s.centre_y = 0.5 * height;
  const double half_height = s.perspective ? std::tan(0.5 * view.fov_y) : 0.5 * view.span_y;
  const double half_width = half_height * view.width / view.height;
  const glm::dmat3 axes = glm::mat3_cast(view.orientation);
  s.to_x = axes[0] * (0.5 * width / half_width);
  s.to_y = axes[1] * (-0.5 * height / half_height);
  s.to_w = -axes[2];
  s.pixels_per_unit = std::max(glm::length(s.to_x), glm::length(s.to_y));
}

void OcclusionBuffer::add_occluder(const OccluderMesh& mesh, const Affine& transform) {
  State& s = *state_;
  if (mesh.triangle_count == 0) return;
  const glm::dmat4 to_world = to_matrix(transform);
  const glm::dmat3 linear(to_world);
  const double volume = glm::determinant(linear);
  if (!(std::abs(volume) > 1e-30)) return;
  Aabb bounds;
  for (int i = 0; i < 8; ++i) bounds.extend(transform_point(transform, mesh.bounds.corner(i)));
  const Footprint f = s.footprint(bounds);
  if (s.outside_image(f)) return;
  ++s.counts.occluders;
  s.counts.occluder_triangles += mesh.triangle_count;

  const Margins margins = s.margins(f, mesh, transform);
  const glm::dmat3 view_rows = glm::transpose(glm::dmat3(s.to_x, s.to_y, s.to_w));
  const glm::dmat3 rows = view_rows * linear;
  const glm::dvec3 from_eye = glm::dvec3(to_world[3]) - s.eye;
  const glm::dvec3 eye = -(glm::inverse(linear) * from_eye);
  const bool mirrored = volume < 0;
  raster::FillCounts filled;
  if (s.within_guard(f, mesh, rows, eye)) {
    ScreenTransform t{};
    for (int axis = 0; axis < 3; ++axis) {
      t.eye_high[axis] = static_cast<float>(eye[axis]);
      t.eye_low[axis] = static_cast<float>(eye[axis] - t.eye_high[axis]);
      t.to_x[axis] = static_cast<float>(rows[axis][0]);
      t.to_y[axis] = static_cast<float>(rows[axis][1]);
      t.to_w[axis] = static_cast<float>(rows[axis][2]);
    }
    t.centre_x = static_cast<float>(s.centre_x);
    t.centre_y = static_cast<float>(s.centre_y);
    t.perspective = s.perspective;
    s.kernels->draw_mesh(mesh, t, mirrored, margins, s.tiles, s.scratch, filled);
  } else {
    const double guard = std::max<double>(float_guard, std::max(s.tiles.width, s.tiles.height));
    const raster::ClipTransform t{rows, view_rows * from_eye, {s.centre_x, s.centre_y}, s.near, guard, s.perspective};
    raster::draw_clipped(mesh, t, mirrored, margins, *s.kernels, s.tiles, filled);
  }
  s.counts.triangles_filled += filled.triangles;
  s.counts.tiles_filled += filled.tiles;
  s.counts.contour_edges += filled.contour_edges;
}

void OcclusionBuffer::finish() { state_->kernels->reduce(state_->tiles); }

bool OcclusionBuffer::may_be_seen(const Aabb& box) const {
  const State& s = *state_;
  if (box.empty()) return false;
  const Footprint f = s.footprint(box);
  if (f.farthest < s.near * (1.0 - 1e-6) && s.perspective) return false;
  if (s.perspective && !(f.nearest > s.near)) return true;
  const double margin = base_margin;
  const double x0 = std::floor(f.x0 - margin), y0 = std::floor(f.y0 - margin);
  const double x1 = std::floor(f.x1 + margin) + 1, y1 = std::floor(f.y1 + margin) + 1;
  const int left = static_cast<int>(std::clamp(x0, 0.0, static_cast<double>(s.tiles.width)));
  const int right = static_cast<int>(std::clamp(x1, 0.0, static_cast<double>(s.tiles.width)));
  const int top = static_cast<int>(std::clamp(y0, 0.0, static_cast<double>(s.tiles.height)));
  const int bottom = static_cast<int>(std::clamp(y1, 0.0, static_cast<double>(s.tiles.height)));
  if (left >= right || top >= bottom) return false;
  const double near = s.perspective ? 1.0 / f.nearest : -f.nearest;
  const auto raised = static_cast<float>(near + std::abs(near) * 0x1p-20);
  return !s.kernels->hides(s.tiles, left, top, right, bottom, raised);
}

int OcclusionBuffer::width() const { return state_->tiles.width; }
int OcclusionBuffer::height() const { return state_->tiles.height; }

float OcclusionBuffer::hidden_beyond(int x, int y) const {
  const raster::Tiles& t = state_->tiles;
  const int tile = y / raster::tile_size * t.across + x / raster::tile_size;
  const int lane = y % raster::tile_size * raster::tile_size + x % raster::tile_size;
  const float near = t.hidden[static_cast<std::size_t>(tile) * raster::tile_pixels + static_cast<std::size_t>(lane)];
  if (near == raster::nothing_near) return std::numeric_limits<float>::infinity();
  return state_->perspective ? 1.0f / near : -near;
}

const OcclusionCounts& OcclusionBuffer::counts() const { return state_->counts; }
const char* OcclusionBuffer::target() const { return state_->kernels->target; }

}  // namespace sightline
