// Ray casting (Appel 1968; checklist 13.01, 13.02 for opaque surfaces, 13.12, 13.13): per pixel centre one ray, the
// nearest triangle that it meets, through any of the tracing structures. Promise: exact up to the stated depth error;
// at equal depth the lower object, then the lower triangle.
#pragma once

#include <memory>

#include "sightline/core/algorithm.hpp"

namespace sightline {

std::unique_ptr<Renderer> make_ray_cast(const IndexedScene& scene, ParameterReader& parameters);

}  // namespace sightline
