// Pictures of what occlusion cullers work with: occluders beside the scene, the horizon over it, the overlap pyramid.
#pragma once

#include "picture.hpp"

namespace sightline::cli {

enum class OcclusionShow {
  occluders,  // the scene, and to its right the automatic occluders alone, one colour for each object
  horizon,    // the scene, tinted where the walls of all its objects hide what is behind, with the line on top
  overlap     // the overlap pyramid of all opaque objects: level 0, and to its right the levels above
};

/// `occluders` is needed for OcclusionShow::occluders only.
Picture picture_occlusion(const Scene& scene, const Scene& occluders, const View& view, OcclusionShow show);

}  // namespace sightline::cli
