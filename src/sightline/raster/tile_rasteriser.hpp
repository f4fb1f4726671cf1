// The fast exact z-buffer: the screen in tiles of 256 x 128 pixels, each drawn by one thread in memory of its own, with
// SIMD loops; and the hierarchical z-buffer (Greene 1993; checklist 5) as the same loops with objects, clusters and
// tiles rejected front to back. Promise: the nearest surface at every pixel centre; same image and counts for any
// number of threads and every SIMD target. Depth is computed in floats from vertices that are not snapped.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sightline/core/frame.hpp"
#include "sightline/raster/tile_kernels.hpp"
#include "sightline/scene/view.hpp"

namespace sightline::raster {

struct TileSettings {
  bool ids = true;            // object and triangle per pixel, and counts of fragments; otherwise depth alone
  bool hierarchical = false;  // front to back with three levels of rejection
  bool cull_back = false;     // leave out triangles that are clockwise on the screen
  bool count_writes = false;  // TileStats::writes; needs ids
  bool scalar = false;        // the reference loops instead of the machine's SIMD ones
};

struct TileStats {
  std::uint64_t objects = 0, objects_hidden = 0;    // per screen tile: tested, rejected by the hierarchy
  std::uint64_t clusters = 0, clusters_hidden = 0;  // likewise
  std::uint64_t triangles_in = 0;                   // of the clusters drawn
  TileCounts work;
  std::vector<std::uint32_t> writes;  // depth writes per pixel, if asked for
  std::vector<float> farthest;        // hierarchical: farthest distance in each 8 x 8 tile of the image, metres
};

class TileRasteriser {
 public:
  /// Cuts the meshes into clusters; the scene must outlive it.
  explicit TileRasteriser(const Scene& scene);
  ~TileRasteriser();

  /// Draws the objects (no id twice) as seen from `view`; every plane of `frame` that is kept is written at every
  /// pixel. Without ids the planes `object` and `triangle` are empty.
  void draw(const View& view, std::span<const ObjectId> objects, const TileSettings& settings, Frame& frame,
            TileStats& stats) const;

  /// Name of the SIMD target in use.
  static const char* target(bool scalar = false);

 private:
  const Scene& scene_;
  std::vector<ClusterMesh> meshes_;
};

}  // namespace sightline::raster
