#include "sightline/scene/scene_soup.hpp"

#include <numeric>

#include "sightline/scene/input_error.hpp"

namespace sightline {

TriangleSoup soup_of(const Scene& scene) {
  std::vector<ObjectId> all(scene.objects().size());
  std::iota(all.begin(), all.end(), 0u);
  return soup_of(scene, all);
}

TriangleSoup soup_of(const Scene& scene, std::span<const ObjectId> objects) {
  std::uint64_t count = 0;
  for (const ObjectId id : objects) count += scene.mesh_of(id).triangles.size();
  if (count >= (std::uint64_t{1} << 28))
    throw InputError("the scene has " + std::to_string(count) + " triangles; tracing structures hold 2^28");
  TriangleSoup soup;
  soup.corners.reserve(3 * count);
  soup.first.push_back(0);
  std::vector<glm::vec3> world;
  for (const ObjectId id : objects) {
    const Mesh& mesh = scene.mesh_of(id);
    if (mesh.triangles.empty()) continue;
    world.clear();
    for (const glm::vec3& p : mesh.positions) world.push_back(transform_point(scene.objects()[id].transform, p));
    for (const glm::uvec3& v : mesh.triangles)
      soup.corners.insert(soup.corners.end(), {world[v.x], world[v.y], world[v.z]});
    soup.object.push_back(id);
    soup.first.push_back(static_cast<std::uint32_t>(soup.size()));
  }
  return soup;
}

}  // namespace sightline
