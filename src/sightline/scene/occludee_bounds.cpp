#include "sightline/scene/occludee_bounds.hpp"

#include <limits>

#include "sightline/parallel/parallel.hpp"

namespace sightline {
namespace {

constexpr std::uint64_t most_placed_triangles = 8'000'000;

/// The rounding of transform_point for points of the mesh.
glm::vec3 slack_of(const Mesh& mesh, const Affine& m) {
  const glm::vec3 size = glm::max(glm::abs(mesh.bounds.lo), glm::abs(mesh.bounds.hi));
  const glm::vec3 terms = glm::abs(m[0]) * size.x + glm::abs(m[1]) * size.y + glm::abs(m[2]) * size.z + glm::abs(m[3]);
  return terms * (4.0f * std::numeric_limits<float>::epsilon());
}

std::vector<Aabb> place(const Mesh& mesh, const TightBounds& tight, const Object& object, bool corners) {
  std::vector<Aabb> boxes(tight.boxes.size());
  if (corners) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k)
        boxes[tight.box_of[t]].extend(transform_point(object.transform, mesh.positions[mesh.triangles[t][k]]));
  } else {
    for (std::size_t b = 0; b < boxes.size(); ++b)
      for (int i = 0; i < 8; ++i) boxes[b].extend(transform_point(object.transform, tight.boxes[b].corner(i)));
  }
  const glm::vec3 slack = slack_of(mesh, object.transform);
  for (Aabb& box : boxes) box = {box.lo - slack, box.hi + slack};
  return boxes;
}

}  // namespace

OccludeeBounds::OccludeeBounds(const Scene& scene, const TightBoundsConfig& config) : meshes_(scene.meshes().size()) {
  parallel_blocks(meshes_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (config.sigma > 1.0)
        meshes_[i] = tight_bounds(scene.meshes()[i].positions, scene.meshes()[i].triangles, config);
  });
  follow(scene);
}

void OccludeeBounds::follow(const Scene& scene) {
  std::vector<std::vector<Aabb>> placed(scene.objects().size());
  const bool corners = scene.triangle_count() <= most_placed_triangles;
  parallel_blocks(placed.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Object& object = scene.objects()[i];
      const TightBounds& tight = meshes_[object.mesh];
      if (tight.boxes.size() > 1)
        placed[i] = place(scene.meshes()[object.mesh], tight, object, corners);
      else if (!object.bounds.empty())
        placed[i] = {object.bounds};
    }
  });
  boxes_.clear();
  first_.assign(1, 0);
  for (const std::vector<Aabb>& boxes : placed) {
    boxes_.insert(boxes_.end(), boxes.begin(), boxes.end());
    first_.push_back(static_cast<std::uint32_t>(boxes_.size()));
  }
}

}  // namespace sightline
