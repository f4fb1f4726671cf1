// Ray against sphere (checklist 13.05 with E23).
#pragma once

#include "sightline/geometry/ray.hpp"

namespace sightline {

/// The parameters at which a ray's line meets a surface, ascending.
struct Crossings {
  int count = 0;
  double t[2] = {0.0, 0.0};
};

/// Where the ray, within its interval, meets the sphere |x - centre|^2 = radius^2: none, one (it touches, or starts
/// inside) or two. The larger root is found without cancellation (Haines et al. 2019). A radius of 0 is a point; a
/// negative or NaN radius and what is no ray (is_ray) meet nothing.
Crossings hit_sphere(const Ray& ray, const glm::vec3& centre, float radius);

}  // namespace sightline
