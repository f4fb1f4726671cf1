// The trivial potentially visible set: every candidate (checklist 16.01). Promise: conservative-continuous.
#pragma once

#include <memory>

#include "sightline/core/algorithm.hpp"

namespace sightline {

std::unique_ptr<Culler> make_none(const IndexedScene& scene, ParameterReader& parameters);

}  // namespace sightline
