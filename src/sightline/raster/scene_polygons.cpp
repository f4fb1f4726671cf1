#include "sightline/raster/scene_polygons.hpp"

#include <array>
#include <string>

#include "sightline/scene/input_error.hpp"

namespace sightline {

ScenePolygons scene_polygons(const Scene& scene, std::uint64_t most, const char* method) {
  if (scene.triangle_count() > most)
    throw InputError(std::string(method) + ": the scene has " + std::to_string(scene.triangle_count()) +
                     " triangles, more than " + std::to_string(most));
  ScenePolygons result;
  result.owners.reserve(scene.triangle_count());
  result.polygons.corners.reserve(3 * scene.triangle_count());
  result.polygons.ends.reserve(scene.triangle_count());
  for (ObjectId id = 0; id < scene.objects().size(); ++id) {
    const Object& object = scene.objects()[id];
    const Mesh& mesh = scene.meshes()[object.mesh];
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      std::array<glm::dvec3, 3> corners;
      for (int k = 0; k < 3; ++k)
        corners[static_cast<std::size_t>(k)] =
            glm::dvec3(transform_point(object.transform, mesh.positions[mesh.triangles[t][k]]));
      result.polygons.add(corners);
      result.owners.push_back({id, t});
    }
  }
  return result;
}

}  // namespace sightline
