// Hierarchical occlusion maps (Zhang, Manocha, Hudson, Hoff 1997; Zhang 1998; checklist 5.18, 21.06, 21.07): selected
// occluders are drawn into an overlap pyramid; their depth is estimated per block of the image. An object is dropped if
// its rectangle is covered and lies behind the estimate. Promise: conservative-continuous with opacity threshold 1;
// approximate below.
#pragma once

#include <memory>

#include "sightline/core/algorithm.hpp"

namespace sightline {

/// Parameters: `depth`: estimated from what was "buffer" drawn or from the "boxes" of the occluders; resolution,
/// triangles, min_size, scalar and tight of the stage (cull/occlusion_stage.hpp); `opacity`: share of a cell that must
/// be covered, 0.5 to 1; `holes`: view pixels of a hole that may be ignored, 0 to 10^6; `block`: pixels across a block
/// of the depth estimate, 1 to 256.
std::unique_ptr<Culler> make_occlusion_hom(const IndexedScene& scene, ParameterReader& parameters);

}  // namespace sightline
