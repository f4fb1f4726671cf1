#include "sightline/scene/frustum_shape.hpp"

#include <cmath>
#include <vector>

namespace sightline {

std::array<glm::dvec3, 8> frustum_corners(const View& view, double reach) {
  const glm::dmat3 axes = glm::mat3_cast(view.orientation);
  const double aspect = static_cast<double>(view.width) / view.height;
  std::array<glm::dvec3, 8> corners;
  for (int i = 0; i < 8; ++i) {
    const double distance = i < 4 ? view.near : std::min(view.far, std::max(reach, 2.0 * view.near));
    const double half =
        view.projection == Projection::perspective ? distance * std::tan(0.5 * view.fov_y) : 0.5 * view.span_y;
    corners[static_cast<std::size_t>(i)] = view.eye - axes[2] * distance +
                                           axes[0] * ((i & 1) != 0 ? half * aspect : -half * aspect) +
                                           axes[1] * ((i & 2) != 0 ? half : -half);
  }
  return corners;
}

Sphere frustum_sphere(const View& view, double reach) {
  std::vector<glm::vec3> points;
  for (const glm::dvec3& corner : frustum_corners(view, reach)) points.emplace_back(corner);
  Sphere sphere = smallest_sphere(points);
  sphere.radius *= 1.000001f;
  sphere.radius += static_cast<float>(1e-6 * glm::length(view.eye));
  return sphere;
}

Aabb frustum_box(const View& view, double reach) {
  Aabb box;
  for (const glm::dvec3& corner : frustum_corners(view, reach)) box.extend(glm::vec3(corner));
  const glm::vec3 slack(1e-6f * (glm::length(box.extent()) + static_cast<float>(glm::length(view.eye))));
  return {box.lo - slack, box.hi + slack};
}

}  // namespace sightline
