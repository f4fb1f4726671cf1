// Objects against a hierarchical z-buffer (Greene, Kass, Miller 1993; checklist 5.17, 21.02, 21.05-21.07, 21.16): each
// box is tested coarse to fine against a z-pyramid over a conservative depth image; what may be seen is drawn into it
// at once. Promise: conservative-continuous; approximate with a pixel threshold.
#pragma once

#include <memory>

#include "sightline/core/algorithm.hpp"

namespace sightline {

/// Parameters: those of the stage (cull/occlusion_stage.hpp); `fan`: cells across and down that make one of the next
/// level, 2 to 16; `pixels`: objects of which at most so many view pixels are open count as hidden, 0 to 10^6.
std::unique_ptr<Culler> make_occlusion_hzb(const IndexedScene& scene, ParameterReader& parameters);

}  // namespace sightline
