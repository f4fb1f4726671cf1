// All triangles of a scene in world space, as polygons that know their object and triangle: what the algorithms that
// sort or cut polygons begin with. World positions are those of the oracle (transform_point in float).
#pragma once

#include <vector>

#include "sightline/index/bsp.hpp"
#include "sightline/scene/scene.hpp"

namespace sightline {

struct ScenePolygons {
  PolygonSet polygons;
  /// Of polygon i, ascending by object, then triangle.
  struct Owner {
    ObjectId object;
    std::uint32_t triangle;
  };
  std::vector<Owner> owners;
};

/// Throws InputError naming `method` if there are more than `most` triangles.
ScenePolygons scene_polygons(const Scene& scene, std::uint64_t most, const char* method);

}  // namespace sightline
