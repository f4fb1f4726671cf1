// The virtual occlusion buffer (Bartz, Meissner, Huettner 1999; checklist 5.19, 21.07): the box of an object is
// sampled sparsely against the depth of what was drawn so far; if no sample passes, the object is dropped.
// Promise: approximate, as what shows only between the samples is lost; conservative where every sample is taken
// (step = 1, pixels = 0).
#pragma once

#include <memory>

#include "sightline/core/algorithm.hpp"

namespace sightline {

/// Parameters: those of the stage (cull/occlusion_stage.hpp), the resolution being 1; `step`: pixels between samples
/// across and down, 1 to 64; `pixels`: at most so many passing samples count as hidden, 0 to 10^6.
std::unique_ptr<Culler> make_occlusion_virtual(const IndexedScene& scene, ParameterReader& parameters);

}  // namespace sightline
