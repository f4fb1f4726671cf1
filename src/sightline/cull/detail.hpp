// Detail culling: what looks smaller than so many pixels is dropped (checklist 26). Promise: approximate; the error
// measure is the number of pixels lost.
#pragma once

#include <memory>

#include "sightline/core/algorithm.hpp"

namespace sightline {

/// Parameters: docs/algorithms/detail.md. Throws InputError.
std::unique_ptr<Culler> make_detail(const IndexedScene& scene, ParameterReader& parameters);

}  // namespace sightline
