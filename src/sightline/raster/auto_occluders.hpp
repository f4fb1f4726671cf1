// Occluders that nobody has to author: from every mesh of a scene a few triangles that hide nothing the mesh does not
// hide. Two sources: large flat patches of the surface itself (raster/coplanar_patches.hpp), and boxes inside of closed
// meshes (raster/solid_boxes.hpp). A budget of triangles goes to what has most area per triangle.
#pragma once

#include <cstdint>
#include <vector>

#include "sightline/scene/scene.hpp"

namespace sightline {

struct AutoOccluderConfig {
  std::uint64_t budget = 0;  // triangles, each instance counted; 0: `share` of the scene's
  double share = 0.1;        // 0 to 1
  bool solids = true;        // also boxes inside of closed meshes
  int cells = 16;            // of their voxel grid along each axis, 4 to 128
};

/// The occluder of one mesh, in its space. Positions of `surface` are those of the mesh. Names are left empty.
struct AutoOccluder {
  /// A subset of the mesh's surface: hides what it covers, from wherever.
  Mesh surface;
  /// Boxes inside the mesh: to be used only where the bounds of the whole object lie behind the near plane.
  Mesh solid;
};

struct AutoOccluders {
  std::vector<AutoOccluder> meshes;  // by mesh id
  std::uint64_t triangles = 0;       // of all instances that are opaque
  std::uint64_t surface_triangles = 0, solid_triangles = 0;
};

/// The same for any number of threads. Objects that are not opaque give and cost nothing.
AutoOccluders make_auto_occluders(const Scene& scene, const AutoOccluderConfig& config = {});

/// The whole scene as one occluder in world space, so that patches grow across objects; for scenes that stand still.
/// Only surfaces. Memory is that of a copy of all triangles.
Mesh make_scene_occluder(const Scene& scene, const AutoOccluderConfig& config = {});

}  // namespace sightline
