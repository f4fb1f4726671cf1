#include "sightline/raster/occlusion_projection.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace sightline::raster {
namespace {

constexpr double base_share = 0x1p-16;     // relative: rounding of nearness in perspective
constexpr double base_spread = 0x1p-20;    // of the distance from the eye: rounding of nearness in orthographic views
constexpr double float_guard = 8192;       // pixels from the image's centre within which floats keep base_margin
constexpr double smallest_volume = 1e-30;  // of a transform that is not singular

glm::dvec3 to_row(const glm::dmat3& m, int row) { return {m[0][row], m[1][row], m[2][row]}; }

/// The truth has its vertices rounded to float in world space; an identity transform rounds nothing. Metres.
double world_rounding(const OccluderMesh& mesh, const Affine& transform) {
  if (transform == identity_affine()) return 0.0;
  const glm::vec3 size = glm::max(glm::abs(mesh.bounds.lo), glm::abs(mesh.bounds.hi));
  const glm::vec3 terms = glm::abs(transform[0]) * size.x + glm::abs(transform[1]) * size.y +
                          glm::abs(transform[2]) * size.z + glm::abs(transform[3]);
  return 0x1p-21 * static_cast<double>(std::max({terms.x, terms.y, terms.z}));
}

}  // namespace

ViewTransform::ViewTransform(const View& view, int new_width, int new_height, double new_square)
    : eye(view.eye),
      centre_x(0.5 * new_width),
      centre_y(0.5 * new_height),
      near(view.near),
      square(new_square),
      width(new_width),
      height(new_height),
      perspective(view.projection == Projection::perspective) {
  const double half_height = perspective ? std::tan(0.5 * view.fov_y) : 0.5 * view.span_y;
  const double half_width = half_height * view.width / view.height;
  const glm::dmat3 axes = glm::mat3_cast(view.orientation);
  const double per_x = 0.5 * width / half_width, per_y = 0.5 * height / half_height;
  to_x = axes[0] * per_x;
  to_y = axes[1] * -per_y;
  to_w = -axes[2];
  pixels_per_unit = std::max(per_x, per_y);
  local = {eye,
           axes[0] / per_x,
           axes[1] / -per_y,
           to_w,
           glm::transpose(glm::dmat3(to_x, to_y, to_w)),
           {centre_x, centre_y},
           square,
           base_margin,
           perspective};
}

QueryView ViewTransform::query() const {
  QueryView q{};
  for (int axis = 0; axis < 3; ++axis) {
    q.screen.eye_high[axis] = static_cast<float>(eye[axis]);
    q.screen.eye_low[axis] = static_cast<float>(eye[axis] - q.screen.eye_high[axis]);
    q.screen.to_x[axis] = static_cast<float>(to_x[axis]);
    q.screen.to_y[axis] = static_cast<float>(to_y[axis]);
    q.screen.to_w[axis] = static_cast<float>(to_w[axis]);
    q.eye_low_sum += std::abs(q.screen.eye_low[axis]);
  }
  q.screen.centre_x = static_cast<float>(centre_x);
  q.screen.centre_y = static_cast<float>(centre_y);
  q.screen.perspective = perspective;
  q.pixels_per_unit = static_cast<float>(pixels_per_unit * 1.001);
  q.near_plane = static_cast<float>(near * (1.0 + 1e-7));
  q.square = static_cast<float>(square);
  q.width = width;
  q.height = height;
  return q;
}

Footprint ViewTransform::footprint(std::span<const glm::dvec3> corners) const {
  Footprint f;
  for (const glm::dvec3& corner : corners) {
    const glm::dvec3 d = corner - eye;
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

Footprint ViewTransform::footprint(const Aabb& box) const {
  std::array<glm::dvec3, 8> corners;
  for (int i = 0; i < 8; ++i) corners[static_cast<std::size_t>(i)] = glm::dvec3(box.corner(i));
  return footprint(corners);
}

/// The image of a sphere lies between the tangents through the eye, in each of the planes (x, distance), (y, distance).
Footprint ViewTransform::footprint(const glm::dvec3& centre, double radius) const {
  Footprint f;
  const glm::dvec3 d = centre - eye;
  const double w = glm::dot(to_w, d);
  f.nearest = w - radius;
  f.farthest = w + radius;
  f.spread = glm::length(d) + radius;
  const auto extent = [&](const glm::dvec3& row, double image_centre, double& low, double& high) {
    const double scale = glm::length(row), x = glm::dot(row, d) / scale;
    if (!perspective) {
      low = image_centre + (x - radius) * scale;
      high = image_centre + (x + radius) * scale;
      return;
    }
    const double tangent = std::sqrt(std::max(0.0, x * x + w * w - radius * radius));
    // (x, w) turned by the angle between centre and tangent, either way; before the eye as nearest > 0.
    low = image_centre + scale * (x * tangent - w * radius) / (w * tangent + x * radius);
    high = image_centre + scale * (x * tangent + w * radius) / (w * tangent - x * radius);
  };
  extent(to_x, centre_x, f.x0, f.x1);
  extent(to_y, centre_y, f.y0, f.y1);
  return f;
}

bool ViewTransform::outside_image(const Footprint& f) const {
  if (f.farthest < near) return true;
  if (f.nearest <= near) return false;
  return f.x1 < -1 || f.y1 < -1 || f.x0 > width + 1 || f.y0 > height + 1;
}

std::optional<LocalView> ViewTransform::local_view(const Affine& transform) const {
  const glm::dmat4 to_world = to_matrix(transform);
  const glm::dmat3 linear(to_world);
  const double sizes = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
  if (!(std::abs(glm::determinant(linear)) > std::max(smallest_volume, 1e-6 * sizes))) return std::nullopt;
  const glm::dmat3 inverse = glm::inverse(linear);
  LocalView result = local;
  result.eye = inverse * (eye - glm::dvec3(to_world[3]));
  result.ray_x = inverse * local.ray_x;
  result.ray_y = inverse * local.ray_y;
  result.ray_w = inverse * local.ray_w;
  result.rows = local.rows * linear;
  return result;
}

/// True if the float loops keep base_margin and base_share (or base_spread) for all of a mesh: it lies before the eye,
/// not too far aside, and the products that make up a corner are not much larger than the corner (a squashed mesh).
bool ViewTransform::within_guard(const Footprint& f, const OccluderMesh& mesh, const glm::dmat3& rows,
                                 const glm::dvec3& mesh_eye) const {
  const double aside = std::max({centre_x - f.x0, f.x1 - centre_x, centre_y - f.y0, f.y1 - centre_y});
  if (!(f.nearest > near && aside < float_guard)) return false;
  glm::dvec3 largest(0.0);  // of the sums of the products' sizes for x, y and distance, per unit of distance
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 d = glm::dvec3(mesh.bounds.corner(i)) - mesh_eye;
    const double per_w = perspective ? 1.0 / glm::dot(to_row(rows, 2), d) : 1.0;
    for (int row = 0; row < 3; ++row)
      largest[row] = std::max(largest[row], glm::dot(glm::abs(to_row(rows, row)), glm::abs(d)) * per_w);
  }
  // Four roundings of each product and sum.
  const double pixels = 0x1p-22 * (std::max(largest.x, largest.y) + (perspective ? aside * largest.z : 0.0));
  const double nearness = 0x1p-22 * largest.z;
  return pixels < 0.5 * base_margin && nearness < (perspective ? 0.5 * base_share : 0.5 * base_spread * f.spread);
}

Margins ViewTransform::margins(double nearest, double spread, double rounding) const {
  const auto part = static_cast<float>(square);
  if (!perspective)
    return {part, static_cast<float>(base_margin + rounding * pixels_per_unit), 0.0f,
            static_cast<float>(base_spread * spread + rounding)};
  nearest = std::max(nearest, near);
  return {part, static_cast<float>(base_margin + rounding * pixels_per_unit / nearest),
          static_cast<float>(base_share + rounding / nearest), 0.0f};
}

std::optional<MeshView> ViewTransform::mesh_view(const OccluderMesh& mesh, const Affine& transform) const {
  const glm::dmat4 to_world = to_matrix(transform);
  const glm::dmat3 linear(to_world);
  const double volume = glm::determinant(linear);
  if (!(std::abs(volume) > smallest_volume)) return std::nullopt;
  Aabb bounds;
  for (int i = 0; i < 8; ++i) bounds.extend(transform_point(transform, mesh.bounds.corner(i)));
  const Footprint f = footprint(bounds);
  if (outside_image(f)) return std::nullopt;

  const glm::dmat3 rows = local.rows * linear;
  const glm::dvec3 from_eye = glm::dvec3(to_world[3]) - eye;
  const glm::dvec3 mesh_eye = -(glm::inverse(linear) * from_eye);
  const double rounding = world_rounding(mesh, transform);
  MeshView m;
  m.mirrored = volume < 0;
  for (int axis = 0; axis < 3; ++axis) {
    m.screen.eye_high[axis] = static_cast<float>(mesh_eye[axis]);
    m.screen.eye_low[axis] = static_cast<float>(mesh_eye[axis] - m.screen.eye_high[axis]);
    m.screen.to_x[axis] = static_cast<float>(rows[axis][0]);
    m.screen.to_y[axis] = static_cast<float>(rows[axis][1]);
    m.screen.to_w[axis] = static_cast<float>(rows[axis][2]);
  }
  m.screen.centre_x = static_cast<float>(centre_x);
  m.screen.centre_y = static_cast<float>(centre_y);
  m.screen.perspective = perspective;
  m.partial = !within_guard(f, mesh, rows, mesh_eye);
  const Margins widest = margins(f.nearest, f.spread, rounding);
  m.aside = 2.0f + widest.pixels;
  if (!m.partial) {
    m.margins = widest;
    return m;
  }
  // Nearer than this the rounding of vertices in world space would widen the margins of all the rest.
  const double nearest = std::max(near * (1.0 + 1e-5), perspective ? 16.0 * rounding * pixels_per_unit : 0.0);
  m.nearest = static_cast<float>(nearest * (1.0 + 1e-6));
  m.margins = margins(nearest, f.spread, rounding);
  m.clip_margins = widest;
  m.guard = static_cast<float>(0.5 * float_guard);
  m.error_w = static_cast<float>(perspective ? 0x1p21 * base_share : 0x1p21 * base_spread * f.spread);
  const double guard = std::max<double>(float_guard, std::max(width, height));
  m.clip = {rows, local.rows * from_eye, {centre_x, centre_y}, near, guard, perspective};
  return m;
}

}  // namespace sightline::raster
