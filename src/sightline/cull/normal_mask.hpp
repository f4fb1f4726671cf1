// Back-face culling by classes of normals (Zhang and Hoff 1997, checklist 18). Promise: conservative-continuous.
#pragma once

#include <memory>

#include "sightline/core/algorithm.hpp"

namespace sightline {

/// Parameters: docs/algorithms/normal_mask.md. Throws InputError.
std::unique_ptr<FaceCuller> make_normal_mask(const IndexedScene& scene, ParameterReader& parameters);

}  // namespace sightline
