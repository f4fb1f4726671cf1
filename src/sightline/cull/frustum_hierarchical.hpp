// View-frustum culling down a bounding volume hierarchy with plane masking (Clark 1976; Bishop et al. 1998; checklist
// 20.17, 20.18). Promise: conservative-continuous; the same set as frustum_linear or a smaller one, since a node's box
// holds those of its objects.
#pragma once

#include <memory>

#include "sightline/core/algorithm.hpp"

namespace sightline {

std::unique_ptr<Culler> make_frustum_hierarchical(const IndexedScene& scene, ParameterReader& parameters);

}  // namespace sightline
