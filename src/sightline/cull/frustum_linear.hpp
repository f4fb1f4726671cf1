// View-frustum culling of every object's box, one after the other (Clark 1976; checklist 20.01, 20.12-20.14).
// Promise: conservative-continuous.
#pragma once

#include <memory>

#include "sightline/core/algorithm.hpp"

namespace sightline {

std::unique_ptr<Culler> make_frustum_linear(const IndexedScene& scene, ParameterReader& parameters);

}  // namespace sightline
