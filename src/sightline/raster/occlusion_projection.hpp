// A view of the occlusion buffer in double precision: where things lie in the image, and how an occluder's mesh is to
// be drawn so that the rounding of the float loops stays below the margins. Internal to raster/.
#pragma once

#include <optional>
#include <span>

#include "sightline/geometry/affine.hpp"
#include "sightline/raster/occlusion_hull.hpp"
#include "sightline/raster/occlusion_kernels.hpp"
#include "sightline/scene/view.hpp"

namespace sightline::raster {

inline constexpr double base_margin = 1.0 / 64;  // pixels: rounding of projected corners and edge functions

/// Where something lies: distances along the view direction, and its projection in pixels if all of it lies before the
/// eye.
struct Footprint {
  double nearest = 1e300, farthest = -1e300;
  double x0 = 1e300, y0 = 1e300, x1 = -1e300, y1 = -1e300;
  double spread = 0;  // of its corners from the eye
};

struct ViewTransform {
  // Rows turn world - eye into pixels from the centre (times distance, for perspective) and into distance.
  glm::dvec3 eye{0.0}, to_x{0.0}, to_y{0.0}, to_w{0.0};
  double centre_x = 0, centre_y = 0, near = 0, pixels_per_unit = 1, square = 0.5;
  int width = 0, height = 0;
  bool perspective = true;
  LocalView local{};  // of world space

  ViewTransform() = default;
  /// `square`: half the side of the part of a pixel that counts.
  ViewTransform(const View& view, int width, int height, double square);

  [[nodiscard]] QueryView query() const;
  [[nodiscard]] Footprint footprint(std::span<const glm::dvec3> corners) const;
  [[nodiscard]] Footprint footprint(const Aabb& box) const;
  [[nodiscard]] Footprint footprint(const glm::dvec3& centre, double radius) const;
  [[nodiscard]] bool outside_image(const Footprint& f) const;
  /// Nothing for a transform that is singular or nearly so.
  [[nodiscard]] std::optional<LocalView> local_view(const Affine& transform) const;
  /// Nothing for a singular transform, or if all of the mesh lies outside of the image.
  [[nodiscard]] std::optional<MeshView> mesh_view(const OccluderMesh& mesh, const Affine& transform) const;

 private:
  [[nodiscard]] bool within_guard(const Footprint& f, const OccluderMesh& mesh, const glm::dmat3& rows,
                                  const glm::dvec3& mesh_eye) const;
  [[nodiscard]] Margins margins(double nearest, double spread, double rounding) const;
};

}  // namespace sightline::raster
