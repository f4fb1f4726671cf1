// Back-face culling, every triangle by itself (checklist 17). Promise: conservative-continuous.
#pragma once

#include <memory>

#include "sightline/core/algorithm.hpp"

namespace sightline {

/// Parameters: docs/algorithms/backface.md. Throws InputError.
std::unique_ptr<FaceCuller> make_backface(const IndexedScene& scene, ParameterReader& parameters);

}  // namespace sightline
