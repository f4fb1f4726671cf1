// The camera of the tile rasteriser: the float transforms that its loops take, and for bounds the same in double
// precision with the rounding errors of the float path, so that bounds tests are conservative. Internal to raster/.
#pragma once

#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "sightline/raster/tile_kernels.hpp"
#include "sightline/scene/view.hpp"

namespace sightline::raster {

/// The camera: view-space rows in pixels.
struct TileCamera {
  glm::dvec3 rows[3];  // x and y in pixels times distance (y down), distance
  glm::dvec3 eye;
  double centre_x, centre_y, near, far, guard;
  bool perspective;

  explicit TileCamera(const View& view) : eye(view.eye), near(view.near), far(view.far) {
    perspective = view.projection == Projection::perspective;
    const glm::dmat3 axes = glm::mat3_cast(view.orientation);
    const double aspect = static_cast<double>(view.width) / view.height;
    const double scale_y =
        perspective ? 0.5 * view.height / std::tan(0.5 * view.fov_y) : static_cast<double>(view.height) / view.span_y;
    const double scale_x = perspective ? 0.5 * view.width / (std::tan(0.5 * view.fov_y) * aspect)
                                       : static_cast<double>(view.width) / (view.span_y * aspect);
    rows[0] = axes[0] * scale_x;
    rows[1] = axes[1] * -scale_y;
    rows[2] = -axes[2];
    centre_x = 0.5 * view.width;
    centre_y = 0.5 * view.height;
    guard = std::max(view.width, view.height);
  }

  [[nodiscard]] MeshTransform mesh_transform(const Affine& to_world) const;
};

/// Mesh space to view rows, in double precision, with the rounding errors of the float path.
struct MeshRows {
  glm::dvec4 row[3];
  double slack[3];
  glm::dvec3 largest;  // coordinate of the mesh on each axis

  MeshRows(const TileCamera& camera, const Affine& to_world, const Aabb& bounds) {
    const glm::dmat3 linear{glm::dvec3(to_world[0]), glm::dvec3(to_world[1]), glm::dvec3(to_world[2])};
    const glm::dvec3 place(to_world[3]);
    largest = glm::max(glm::abs(glm::dvec3(bounds.lo)), glm::abs(glm::dvec3(bounds.hi)));
    const glm::dvec3 reach = glm::abs(linear[0]) * largest.x + glm::abs(linear[1]) * largest.y +
                             glm::abs(linear[2]) * largest.z + glm::abs(place) + glm::abs(camera.eye);
    for (int k = 0; k < 3; ++k) {
      row[k] = glm::dvec4(camera.rows[k] * linear, glm::dot(camera.rows[k], place - camera.eye));
      slack[k] = 1e-6 * glm::dot(glm::abs(camera.rows[k]), reach);
    }
  }

  [[nodiscard]] BoxTransform box_transform(const TileCamera& camera) const {
    BoxTransform t{};
    for (int k = 0; k < 4; ++k) {
      t.x[k] = static_cast<float>(row[0][k]);
      t.y[k] = static_cast<float>(row[1][k]);
      t.w[k] = static_cast<float>(row[2][k]);
    }
    t.slack_x = static_cast<float>(2 * slack[0]);
    t.slack_y = static_cast<float>(2 * slack[1]);
    t.slack_w = static_cast<float>(2 * slack[2]);
    t.centre_x = static_cast<float>(camera.centre_x);
    t.centre_y = static_cast<float>(camera.centre_y);
    t.near = static_cast<float>(camera.near);
    t.perspective = camera.perspective;
    return t;
  }

  /// sign * (row k - offset * distance) >= 0, widened by all rounding.
  [[nodiscard]] MeshPlane side(const TileCamera& camera, int k, double offset, double sign) const {
    glm::dvec4 plane = row[k];
    if (camera.perspective)
      plane -= offset * row[2];
    else
      plane.w -= offset;
    plane *= sign;
    return widened(plane, slack[k] + (camera.perspective ? std::abs(offset) * slack[2] : 0.0));
  }
  [[nodiscard]] MeshPlane widened(const glm::dvec4& p, double room) const {
    const double rounding = 2e-6 * (glm::dot(glm::abs(glm::dvec3(p)), largest) + std::abs(p.w));
    return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z),
            static_cast<float>(p.w + room + rounding)};
  }

  /// The planes of the part [x0, x1) x [y0, y1) of the image with one pixel around it, and near and far plane.
  std::size_t planes(const TileCamera& camera, int x0, int y0, int x1, int y1, MeshPlane* out) const {
    std::size_t n = 0;
    out[n++] = side(camera, 0, x0 - 1 - camera.centre_x, 1);
    out[n++] = side(camera, 0, x1 + 1 - camera.centre_x, -1);
    out[n++] = side(camera, 1, y0 - 1 - camera.centre_y, 1);
    out[n++] = side(camera, 1, y1 + 1 - camera.centre_y, -1);
    out[n++] = widened(row[2] - glm::dvec4(0, 0, 0, camera.near), slack[2] + 1e-6 * camera.near);
    if (!std::isinf(camera.far))
      out[n++] = widened(glm::dvec4(0, 0, 0, camera.far) - row[2], slack[2] + 1e-6 * camera.far);
    return n;
  }
};

}  // namespace sightline::raster
