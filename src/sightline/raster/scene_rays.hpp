// Rays against all triangles of a scene in double precision, over one world-space bounding volume hierarchy. Promise:
// exact up to rounding; rays through a shared edge hit one of its triangles; of hits at equal distance the lower
// object, then the lower triangle. The plain one: for shading and queries, not for records.
#pragma once

#include <vector>

#include "sightline/core/visible_set.hpp"
#include "sightline/index/bvh.hpp"
#include "sightline/scene/scene.hpp"

namespace sightline {

/// origin + t * direction; direction of any length > 0. Both ends of [t_min, t_max] belong to it.
struct SceneRay {
  glm::dvec3 origin{0.0}, direction{0.0, 0.0, -1.0};
  double t_min = 0.0, t_max = 0.0;
};

struct SceneRayHit {
  double t = 0.0;
  ObjectId object = no_object;
  std::uint32_t triangle = 0;
};

class SceneRays {
 public:
  /// Keeps a reference to the scene. Throws InputError above `most_triangles`.
  explicit SceneRays(const Scene& scene, std::uint64_t most_triangles = 100'000'000);

  enum class Blockers { all, opaque };
  /// The nearest triangle that the ray meets; false if there is none, or the ray is not finite or has no direction.
  /// `only`: objects outside of that set do not count.
  bool nearest(const SceneRay& ray, SceneRayHit& hit, Blockers blockers = Blockers::all,
               const VisibleSet* only = nullptr) const;
  /// World-space corners of a triangle.
  void corners(ObjectId object, std::uint32_t triangle, glm::dvec3 (&result)[3]) const;

 private:
  struct Face {
    glm::vec3 a, b, c;
    ObjectId object;
    std::uint32_t triangle;
  };
  const Scene& scene_;
  std::vector<Face> faces_;  // in the order of the hierarchy's leaves
  PagedVector<BvhNode> nodes_;
};

}  // namespace sightline
