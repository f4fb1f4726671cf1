// View-frustum culling by a bounding volume of choice (Clark 1976; checklist 20.02-20.06, 20.10-20.16, 20.19). Promise:
// conservative-continuous.
#pragma once

#include <memory>

#include "sightline/core/algorithm.hpp"

namespace sightline {

/// Parameters: docs/algorithms/frustum_bounds.md. Throws InputError.
std::unique_ptr<Culler> make_frustum_bounds(const IndexedScene& scene, ParameterReader& parameters);

}  // namespace sightline
