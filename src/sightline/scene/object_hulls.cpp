#include "sightline/scene/object_hulls.hpp"

#include "sightline/parallel/parallel.hpp"

namespace sightline {

std::vector<ConvexHull> mesh_hulls(const Scene& scene) {
  std::vector<ConvexHull> hulls(scene.meshes().size());
  parallel_blocks(hulls.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) hulls[i] = convex_hull(scene.meshes()[i].positions);
  });
  return hulls;
}

ConvexHull placed_hull(const ConvexHull& mesh_hull, const Affine& transform) {
  ConvexHull hull = mesh_hull;
  float size = glm::length(transform[3]);
  const float stretch = glm::length(transform[0]) + glm::length(transform[1]) + glm::length(transform[2]);
  for (glm::vec3& p : hull.vertices) {
    size = std::max(size, stretch * glm::length(p) + glm::length(transform[3]));
    p = transform_point(transform, p);
  }
  hull.slack = mesh_hull.slack * stretch + 0x1p-20f * size;
  if (determinant(transform) < 0.0f)
    for (glm::uvec3& f : hull.faces) std::swap(f.y, f.z);
  return hull;
}

}  // namespace sightline
