// Ray against axis-aligned box by slabs (Kay and Kajiya 1986), in double: the readable test beside the fast ones inside
// the tracing structures.
#pragma once

#include <optional>

#include "sightline/geometry/aabb.hpp"
#include "sightline/geometry/ray.hpp"

namespace sightline {

/// Part of the ray inside of the box, with `enter <= leave`; within the ray's interval.
struct Passage {
  double enter, leave;
};

/// Faces, edges and corners belong to the box; a ray that runs within a face passes through. Starting inside, `enter`
/// is t_near. Nothing for an empty box or what is no ray.
std::optional<Passage> hit_box(const Ray& ray, const Aabb& box);

}  // namespace sightline
