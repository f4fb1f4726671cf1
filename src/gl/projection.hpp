// The projection as OpenGL draws it here: depth 1 at the near plane, 0 at the far plane (reversed), points given
// relative to the eye, so that a float keeps its digits far from the origin.
#pragma once

#include "sightline/scene/view.hpp"

namespace sightline::gl {

/// Clip space with 0 <= z <= w from world coordinates minus the eye.
inline glm::dmat4 reversed_projection(const View& view) {
  glm::dmat4 m = projection_matrix(view);
  if (view.projection == Projection::orthographic) {
    m[2][2] = 1.0 / (view.far - view.near);
    m[3][2] = view.far / (view.far - view.near);
  } else if (std::isinf(view.far)) {
    m[2][2] = 0.0;
    m[3][2] = view.near;
  } else {
    m[2][2] = view.near / (view.far - view.near);
    m[3][2] = view.near * view.far / (view.far - view.near);
  }
  return m * glm::dmat4(glm::transpose(glm::mat3_cast(view.orientation)));
}

/// Distance along the view direction of a depth value of that projection.
inline double metres(const View& view, float depth) {
  const double d = depth;
  if (view.projection == Projection::orthographic) return view.far - d * (view.far - view.near);
  if (std::isinf(view.far)) return view.near / d;
  return view.near * view.far / (d * (view.far - view.near) + view.near);
}

/// Width of a pixel, metres: at distance 1 for a perspective view, anywhere for an orthographic one.
inline double pixel_size(const View& view) {
  if (view.projection == Projection::orthographic) return view.span_y / view.height;
  return 2.0 * std::tan(0.5 * view.fov_y) / view.height;
}

}  // namespace sightline::gl
