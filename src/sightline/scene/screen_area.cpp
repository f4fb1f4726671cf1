#include "sightline/scene/screen_area.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace sightline {
namespace {

constexpr double pi = 3.14159265358979323846, infinity = std::numeric_limits<double>::infinity();

double image_area(const View& view) { return static_cast<double>(view.width) * view.height; }

double bound_of(const View& view, std::span<const glm::vec3> corners) {
  return std::min(image_area(view), silhouette_area(view, corners));
}

template <class Box>
std::array<glm::vec3, 8> corners_of(const Box& box) {
  std::array<glm::vec3, 8> corners;
  for (int i = 0; i < 8; ++i) corners[static_cast<std::size_t>(i)] = box.corner(i);
  return corners;
}

}  // namespace

double pixels_per_unit(const View& view) {
  return view.projection == Projection::perspective ? 0.5 * view.height / std::tan(0.5 * view.fov_y)
                                                    : view.height / view.span_y;
}

double slide_area(const View& view, const Sphere& sphere) {
  if (sphere.radius < 0.0f) return 0.0;
  const double focal = pixels_per_unit(view), r = static_cast<double>(sphere.radius);
  if (view.projection == Projection::orthographic) return pi * r * r * focal * focal;
  const double d = glm::dot(view_direction(view), glm::dvec3(sphere.centre) - view.eye);
  if (d <= r) return infinity;
  return pi * (r * focal / d) * (r * focal / d);
}

double ellipse_area(const View& view, const Sphere& sphere) {
  if (sphere.radius < 0.0f) return 0.0;
  const double focal = pixels_per_unit(view), r = static_cast<double>(sphere.radius);
  if (view.projection == Projection::orthographic) return pi * r * r * focal * focal;
  const glm::dvec3 to = glm::dvec3(sphere.centre) - view.eye;
  const double d = glm::dot(view_direction(view), to);
  if (d <= r) return infinity;
  // The cone around the sphere meets the image plane in an ellipse with semi-axes a = f r sqrt(l^2 - r^2) / (d^2 - r^2)
  // towards the axis and b = f r / sqrt(d^2 - r^2) across, l the distance of the centre.
  const double squared = d * d - r * r;
  return pi * focal * focal * r * r * std::sqrt(std::max(0.0, glm::dot(to, to) - r * r) / squared) / squared;
}

double silhouette_area(const View& view, std::span<const glm::vec3> corners) {
  if (corners.empty()) return 0.0;
  const double focal = pixels_per_unit(view);
  const glm::dmat3 axes = glm::mat3_cast(view.orientation);
  std::vector<glm::dvec2> points;
  points.reserve(corners.size());
  for (const glm::vec3& corner : corners) {
    const glm::dvec3 to = glm::dvec3(corner) - view.eye;
    const double depth = -glm::dot(axes[2], to);
    if (view.projection == Projection::perspective && !(depth > 1e-6 * glm::length(to))) return infinity;
    const double scale = view.projection == Projection::perspective ? focal / depth : focal;
    points.emplace_back(scale * glm::dot(axes[0], to), scale * glm::dot(axes[1], to));
  }
  return convex_area(points);
}

double screen_area_bound(const View& view, const Sphere& sphere) {
  return std::min(image_area(view), ellipse_area(view, sphere));
}
double screen_area_bound(const View& view, const Aabb& box) {
  return box.empty() ? 0.0 : bound_of(view, corners_of(box));
}
double screen_area_bound(const View& view, const Obb& box) {
  return box.radii.x < 0.0f ? 0.0 : bound_of(view, corners_of(box));
}
double screen_area_bound(const View& view, const Kdop& kdop) { return bound_of(view, polytope(kdop).vertices); }
double screen_area_bound(const View& view, const ConvexHull& hull) { return bound_of(view, hull.vertices); }

}  // namespace sightline
