// Occlusion culling in software: large objects near the eye are drawn into an occlusion buffer, then the hierarchy is
// walked front to back and every box that the buffer hides is dropped with all it holds (after Hasselgren, Andersson,
// Akenine-Moller 2016; checklist 21.02, 21.05, 21.06, 21.09). Promise: conservative-continuous (conservative with
// `centres`), with no memory of earlier frames, so teleports and moved cameras are safe.
#pragma once

#include <memory>
#include <vector>

#include "sightline/core/algorithm.hpp"
#include "sightline/raster/occluder_mesh.hpp"

namespace sightline {

/// Other occluders than the scene's own meshes, simpler ones for example. What they cover must be covered by the meshes
/// that they stand for, from every eye.
struct OccluderSet {
  /// By mesh id, in mesh space; an empty one hides nothing.
  std::vector<OccluderMesh> by_mesh;
  /// By mesh id, in mesh space: what lies inside of a closed mesh, drawn where no part of the object lies before the
  /// near plane; empty without.
  std::vector<OccluderMesh> solids;
};

struct OcclusionMaskedConfig {
  double resolution = 0.25;  // buffer pixels per view pixel along each axis, 1/16 to 2
  int triangles = 16000;     // budget of occluder triangles per frame
  double worth = 128;        // an occluder has at most so many triangles per object that it may still hide
  double min_size = 24;      // view pixels: objects that look smaller hide too little to be drawn
  double detail = 64;        // square view pixels per triangle: objects with finer triangles are not drawn
  bool centres = false;      // promise pixel centres alone; needs resolution 1
  bool scalar = false;       // run the one-lane reference loops; the answer is the same
  double tight = 1.0;        // sigma of tight occludee bounds (scene/occludee_bounds), 1 for one box per object
  bool automatic = false;    // draw the meshes' automatic occluders (raster/auto_occluders.hpp) in their place
  int auto_budget = 0;       // triangles of those over the whole scene; 0: a tenth of the scene's
  std::shared_ptr<const OccluderSet> occluders;  // null: as `automatic` says
};

std::unique_ptr<Culler> make_occlusion_masked(const IndexedScene& scene, const OcclusionMaskedConfig& config);
std::unique_ptr<Culler> make_occlusion_masked(const IndexedScene& scene, ParameterReader& parameters);

}  // namespace sightline
