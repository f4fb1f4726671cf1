#include "sightline/core/algorithm.hpp"

namespace sightline {

std::string_view to_string(Family family) {
  switch (family) {
    case Family::culler:
      return "culler";
    case Family::renderer:
      return "renderer";
    case Family::face_culler:
      return "face culler";
  }
  return "unknown";
}

IndexedScene index_scene(const Scene& scene) { return {scene, build_bvh(scene.object_bounds())}; }

void refit(IndexedScene& scene) { refit(scene.bvh, scene.scene.object_bounds()); }

std::vector<Aabb> bounds_in_tree_order(const IndexedScene& scene) {
  std::vector<Aabb> boxes;
  boxes.reserve(scene.bvh.items.size());
  for (const std::uint32_t id : scene.bvh.items) boxes.push_back(scene.scene.objects()[id].bounds);
  return boxes;
}

}  // namespace sightline
