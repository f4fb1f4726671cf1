// What sightline faces finds out about clusters besides the registry's rows: the sweep over cluster sizes (19.17) and
// whether a rotated frame helps (19.09); and the pictures of a normal mask (18.11) and a culling volume (19.07).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "picture.hpp"
#include "sightline/core/algorithm.hpp"

namespace sightline::cli {

struct FrameResult {
  std::string frame;       // of the normals
  double probability = 0;  // mean share of the viewpoints that cull, of sampled eyes
  double culled = 0;       // share of the back-facing triangles found from the eyes of the views
};

/// Leaf clusters of the solid meshes of a scene (at most some thousands), their normals bounded in different frames,
/// and how many triangles are culled from the eyes of `views`.
std::vector<FrameResult> rotated_frames(const Scene& scene, std::span<const View> views);

/// The direction cube unfolded beside the mesh itself: green turns its back in this view. The largest solid object.
Picture draw_mask(const Scene& scene, const View& view);

/// A cluster of the largest solid mesh in red, and its culling volume, cut off at the viewpoints of the cost model.
Picture draw_culling_volume(const Scene& scene);

}  // namespace sightline::cli
