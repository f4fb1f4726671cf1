// A low-resolution image of what is hidden, conservative by construction at any resolution and between samples:
// occluder coverage is rounded inwards and depth away from the eye, occludees outwards and towards the eye. Descends
// from masked software occlusion culling (Hasselgren, Andersson, Akenine-Moller 2016; checklist 5.17, E43), with full
// depth per pixel. Promise: conservative-continuous, or conservative if pixel centres alone are to count. A C interface
// is in occlusion_buffer.h.
#pragma once

#include <memory>
#include <span>

#include "sightline/geometry/affine.hpp"
#include "sightline/geometry/sphere.hpp"
#include "sightline/raster/occluder_mesh.hpp"
#include "sightline/scene/view.hpp"

namespace sightline {

/// Since begin().
struct OcclusionCounts {
  std::uint64_t occluders = 0, occluder_triangles = 0;   // those that were not hidden when their turn came
  std::uint64_t triangles_filled = 0, tiles_filled = 0;  // summed over the threads' strips of columns: depend on these
};

/// What of a pixel must be hidden for it to count: all of its square, or its centre alone. The latter is for a buffer
/// with the very pixels of the image that is rendered, or with k x k times as many: then the promise is for a grid of k
/// x k samples in each pixel of the image, no more and no less.
enum class Coverage { squares, centres };

/// An occluder in the scene; `transform`: mesh space to world space. The mesh must live until it has been added.
struct OccluderInstance {
  const OccluderMesh* mesh = nullptr;
  Affine transform = identity_affine();
};

/// The box `bounds` under `transform`, which may rotate, scale and shear.
struct OrientedBox {
  Affine transform = identity_affine();
  Aabb bounds;
};

/// Between begin() and the next begin() occluders are added and questions asked, in any order; what is added later only
/// hides more. Depth conventions of the renderer (reversed, infinite far plane) do not matter: the buffer takes the
/// view, not a projection matrix, and ignores its far plane. After the first frames nothing is allocated. The bits are
/// the same for every SIMD target, number of threads and order of occluders.
class OcclusionBuffer {
 public:
  /// `scalar`: run the one-lane reference loops instead of the machine's best; the bits are the same.
  explicit OcclusionBuffer(bool scalar = false);
  ~OcclusionBuffer();
  OcclusionBuffer(OcclusionBuffer&&) noexcept;
  OcclusionBuffer& operator=(OcclusionBuffer&&) noexcept;

  /// Starts a view with nothing hidden. width x height: pixels of the buffer, 1 to 16384, independent of the view's for
  /// Coverage::squares, the same multiple of both of them for Coverage::centres. The view must pass check_view.
  void begin(const View& view, int width, int height, Coverage coverage = Coverage::squares);

  /// Adds an occluder, which must be opaque. Parts before the near plane hide nothing. Nothing happens for a singular
  /// transform. Near ones first is fastest.
  void add_occluder(const OccluderMesh& mesh, const Affine& transform);

  /// Adds several, the near ones first, with all threads. Those that lie behind what is hidden already cost little.
  void add_occluders(std::span<const OccluderInstance> occluders);

  /// Adds triangles as they are, mesh space to world space by `transform`; their edges are matched by vertex index
  /// every time, so for meshes that stay make an OccluderMesh once. Indices must lie within positions.
  void add_occluder(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                    const Affine& transform);

  /// False only if no point of the occludee (world space) can be seen between near plane and occluders; true if it may
  /// be. May be called from several threads at once, not while an occluder is added. Empty boxes are not seen.
  [[nodiscard]] bool may_be_seen(const Aabb& box) const;
  [[nodiscard]] bool may_be_seen(const OrientedBox& box) const;
  [[nodiscard]] bool may_be_seen(const Sphere& sphere) const;
  [[nodiscard]] bool may_be_seen(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) const;

  /// The same by the rectangle around the box alone: faster, finds less. What it finds hidden is hidden.
  [[nodiscard]] bool may_be_seen_by_rectangle(const Aabb& box) const;

  /// seen[i] = may_be_seen(boxes[i]) for all, with all threads and several boxes per vector. Sizes must be equal.
  /// `outlines` false: by rectangles alone.
  void test(std::span<const Aabb> boxes, std::span<std::uint8_t> seen, bool outlines = true) const;

  [[nodiscard]] int width() const;
  [[nodiscard]] int height() const;
  /// Distance along the view direction beyond which all in the pixel's square (or at its centre) is hidden, metres;
  /// infinity where nothing is.
  [[nodiscard]] float hidden_beyond(int x, int y) const;
  [[nodiscard]] const OcclusionCounts& counts() const;
  /// Name of the SIMD target in use, or "scalar".
  [[nodiscard]] const char* target() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sightline
