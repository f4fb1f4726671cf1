// A low-resolution image of what is hidden, conservative by construction at any resolution and between samples:
// occluder coverage is rounded inwards and depth away from the eye, occludees outwards and towards the eye. Descends
// from masked software occlusion culling (Hasselgren, Andersson, Akenine-Moller 2016; checklist 5.17, E43), with full
// depth per pixel. Promise: conservative-continuous.
#pragma once

#include <memory>

#include "sightline/geometry/affine.hpp"
#include "sightline/raster/occluder_mesh.hpp"
#include "sightline/scene/view.hpp"

namespace sightline {

struct OcclusionCounts {
  std::uint64_t occluders = 0, occluder_triangles = 0, triangles_filled = 0, tiles_filled = 0, contour_edges = 0;
};

class OcclusionBuffer {
 public:
  /// `scalar`: run the one-lane reference loops instead of the machine's best; the bits are the same.
  explicit OcclusionBuffer(bool scalar = false);
  ~OcclusionBuffer();
  OcclusionBuffer(OcclusionBuffer&&) noexcept;
  OcclusionBuffer& operator=(OcclusionBuffer&&) noexcept;

  /// Starts a view with nothing hidden. width x height: pixels of the buffer, independent of the view's, 1 to 16384.
  void begin(const View& view, int width, int height);

  /// Adds an occluder. `transform`: mesh space to world space. Parts before the near plane hide nothing. Order does not
  /// matter. Nothing happens for a singular transform.
  void add_occluder(const OccluderMesh& mesh, const Affine& transform);

  /// Makes tests fast after the last occluder. Tests before it are as right.
  void finish();

  /// False only if no point of the box (world space) can be seen between near plane and occluders; true if it may be.
  /// May be called from several threads at once.
  [[nodiscard]] bool may_be_seen(const Aabb& box) const;

  [[nodiscard]] int width() const;
  [[nodiscard]] int height() const;
  /// Distance along the view direction beyond which all in the pixel's square is hidden, metres; infinity where nothing
  /// is.
  [[nodiscard]] float hidden_beyond(int x, int y) const;
  [[nodiscard]] const OcclusionCounts& counts() const;
  /// Name of the SIMD target in use, or "scalar".
  [[nodiscard]] const char* target() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sightline
