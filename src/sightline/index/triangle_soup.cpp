#include "sightline/index/triangle_soup.hpp"

namespace sightline {

std::vector<Aabb> bounds_of_triangles(const TriangleSoup& soup) {
  std::vector<Aabb> boxes(soup.size());
  for (std::uint32_t i = 0; i < boxes.size(); ++i) boxes[i] = triangle_bounds(soup.triangle(i));
  return boxes;
}

Aabb bounds_of(const TriangleSoup& soup) {
  Aabb bounds;
  for (const glm::vec3& corner : soup.corners) bounds.extend(corner);
  return bounds;
}

}  // namespace sightline
