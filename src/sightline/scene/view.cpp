#include "sightline/scene/view.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sightline/scene/input_error.hpp"

namespace sightline {
namespace {

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

}  // namespace

void check_view(const View& v) {
  constexpr double degree = 3.14159265358979323846 / 180.0;
  if (!finite(v.eye)) throw InputError("the eye of the view is not finite");
  if (glm::length(v.eye) > largest_distance)
    throw InputError("the eye of the view is farther than 1e15 m from the origin");
  const double norm = glm::length(v.orientation);
  if (!(std::abs(norm - 1.0) < 1e-6)) throw InputError("the orientation of the view is not a unit quaternion");
  if (v.projection == Projection::perspective) {
    if (!(v.fov_y > 0.006 * degree && v.fov_y < 179.994 * degree))
      throw InputError("the field of view must lie between 0.006 and 179.994 degrees");
    if (!(v.far > v.near)) throw InputError("the far plane must lie beyond the near plane");
  } else {
    if (!(v.span_y >= smallest_distance && v.span_y <= largest_distance))
      throw InputError("the height of an orthographic view must be 1e-9 to 1e15 m");
    if (!(v.far > v.near && std::isfinite(v.far)))
      throw InputError("the far plane of an orthographic view must be finite and beyond the near plane");
  }
  if (!(v.near >= smallest_distance && v.near <= largest_distance))
    throw InputError("the near plane must lie at a distance of 1e-9 to 1e15 m");
  if (v.width < 1 || v.height < 1 || v.width > 16384 || v.height > 16384)
    throw InputError("the viewport must be 1 to 16384 pixels wide and high");
}

View look_along(const glm::dvec3& eye, const glm::dvec3& direction, const glm::dvec3& up) {
  const double largest = std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
  if (!finite(direction) || !(largest > 0.0)) throw InputError("the view direction must be finite and not zero");
  const glm::dvec3 back = -glm::normalize(direction / largest);  // in two steps: squares of extreme numbers overflow
  glm::dvec3 right = glm::cross(up, back);
  if (!(glm::length(right) > 1e-9))  // looking along `up`: any perpendicular will do, the least aligned axis is safe
    right = glm::cross(std::abs(back.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1), back);
  right = glm::normalize(right);
  View view;
  view.eye = glm::dvec3(glm::vec3(eye));
  view.orientation = glm::normalize(glm::quat_cast(glm::dmat3(right, glm::cross(back, right), back)));
  return view;
}

glm::dvec3 view_direction(const View& view) { return -(glm::mat3_cast(view.orientation)[2]); }

glm::dmat4 view_matrix(const View& view) {
  const glm::dmat3 to_view = glm::transpose(glm::mat3_cast(view.orientation));
  glm::dmat4 m(to_view);
  m[3] = glm::dvec4(-(to_view * view.eye), 1.0);
  return m;
}

glm::dmat4 projection_matrix(const View& v) {
  const double aspect = static_cast<double>(v.width) / v.height;
  glm::dmat4 m(0.0);
  if (v.projection == Projection::perspective) {
    const double f = 1.0 / std::tan(0.5 * v.fov_y);
    m[0][0] = f / aspect;
    m[1][1] = f;
    m[2][3] = -1.0;
    if (std::isinf(v.far)) {
      m[2][2] = -1.0;
      m[3][2] = -2.0 * v.near;
    } else {
      m[2][2] = -(v.far + v.near) / (v.far - v.near);
      m[3][2] = -2.0 * v.far * v.near / (v.far - v.near);
    }
  } else {
    m[0][0] = 2.0 / (v.span_y * aspect);
    m[1][1] = 2.0 / v.span_y;
    m[2][2] = -2.0 / (v.far - v.near);
    m[3][2] = -(v.far + v.near) / (v.far - v.near);
    m[3][3] = 1.0;
  }
  return m;
}

glm::dmat4 view_projection(const View& view) { return projection_matrix(view) * view_matrix(view); }

Frustum view_frustum(const View& view, double reach) {
  return frustum_of(view_projection(view), std::max(reach, glm::length(view.eye)));
}

PixelRay pixel_ray(const View& v, double x, double y) {
  const double aspect = static_cast<double>(v.width) / v.height;
  const double right = (2.0 * x / v.width - 1.0) * aspect, up = 1.0 - 2.0 * y / v.height;
  const glm::dmat3 axes = glm::mat3_cast(v.orientation);
  if (v.projection == Projection::perspective) {
    const double t = std::tan(0.5 * v.fov_y);
    return {v.eye, axes * glm::dvec3(right * t, up * t, -1.0), v.near, v.far};
  }
  const double half = 0.5 * v.span_y;
  return {v.eye + axes * glm::dvec3(right * half, up * half, 0.0), -axes[2], v.near, v.far};
}

Aabb frustum_bounds(const View& v) {
  Aabb box;
  for (int i = 0; i < 4; ++i) {
    const PixelRay ray = pixel_ray(v, (i & 1) != 0 ? v.width : 0, (i & 2) != 0 ? v.height : 0);
    for (const double t : {ray.t_near, ray.t_far})
      for (int axis = 0; axis < 3; ++axis) {
        const double along = ray.direction[axis] * t;
        const double at = std::isnan(along) ? ray.origin[axis] : ray.origin[axis] + along;
        const double slack = 1e-6 * (std::abs(ray.origin[axis]) + glm::length(ray.direction) * std::min(t, 1e30));
        box.lo[axis] = std::min(box.lo[axis], static_cast<float>(at - slack));
        box.hi[axis] = std::max(box.hi[axis], static_cast<float>(at + slack));
      }
  }
  return box;
}

std::string describe(const View& v) {
  const glm::dvec3 d = view_direction(v);
  char text[256];
  char lens[64];
  if (v.projection == Projection::perspective)
    std::snprintf(lens, sizeof lens, "--fov %.6g", v.fov_y * 180.0 / 3.14159265358979323846);
  else
    std::snprintf(lens, sizeof lens, "--ortho %.6g", v.span_y);
  std::snprintf(text, sizeof text, "--eye %.9g,%.9g,%.9g --look %.9g,%.9g,%.9g %s --size %dx%d --near %.6g --far %.6g",
                v.eye.x, v.eye.y, v.eye.z, d.x, d.y, d.z, lens, v.width, v.height, v.near, v.far);
  return text;
}

}  // namespace sightline
