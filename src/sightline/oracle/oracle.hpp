// The truth: which objects are seen through the sample points of a view, by rays (Embree, robust mode). The
// rasterisation rules are stated here once: pixel (x, y) with n x n samples is sampled at (x + (i + 0.5) / n, y + (j +
// 0.5) / n); only surfaces between the near and the far plane count; both sides of a triangle are seen; of surfaces at
// equal depth the lower object id, then the lower triangle id, should win, but rays cannot promise that below
// `depth_error`.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "sightline/core/frame.hpp"
#include "sightline/core/visible_set.hpp"
#include "sightline/scene/view.hpp"

namespace sightline {

/// Relative error of the depth of a hit: two surfaces closer than depth_error * (distance + reach of the scene) may be
/// seen in either order.
inline constexpr double depth_error = 4e-6;

struct Truth {
  /// Objects seen through at least one sample: the nearest one, and those behind it as long as all in front of them are
  /// not opaque.
  VisibleSet seen;
  /// For every object the number of samples through which it is seen.
  std::vector<std::uint32_t> samples;
  /// n, as in n x n samples per pixel.
  int samples_per_axis = 1;
};

/// What a culler's answer is worth.
struct Verdict {
  std::size_t truth = 0;             // objects seen
  std::vector<ObjectId> missed;      // seen but not in the answer, ascending
  std::uint64_t missed_samples = 0;  // samples through which those are seen
  std::size_t extra = 0;             // in the answer but not seen
};

/// A surface that the ray of a sample meets.
struct SurfaceHit {
  ObjectId object = no_object;
  std::uint32_t triangle = 0;  // within the object's mesh
  float depth = 0.0f;          // along the view direction, metres
};

/// Samples [x0, x1) x [y0, y1) of a view's image, counted in samples (n x n for each pixel) from the top left.
struct SampleRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  [[nodiscard]] bool empty() const { return x0 >= x1 || y0 >= y1; }
};

class Oracle {
 public:
  /// Builds the ray structures; the scene must outlive the oracle.
  explicit Oracle(const Scene& scene);
  /// The same as if the scene had only the objects of `only` (a set over all of its ids); ids stay what they are.
  Oracle(const Scene& scene, const VisibleSet& only);
  ~Oracle();
  Oracle(const Oracle&) = delete;
  Oracle& operator=(const Oracle&) = delete;

  /// Objects seen through samples_per_axis^2 samples of every pixel. Runs on all threads; the same for any number.
  [[nodiscard]] Truth look(const View& view, int samples_per_axis = 1) const;

  /// Calls sample(x, y, hits) for every sample of `part`: the surfaces that its ray meets, from near to far, up to and
  /// including the first opaque one. The same rays and answers as those of look(). Called from many threads at once,
  /// each sample once.
  using SampleSink = std::function<void(int x, int y, std::span<const SurfaceHit> hits)>;
  void trace(const View& view, int samples_per_axis, const SampleRect& part, const SampleSink& sample) const;

  /// For every pixel centre the number of surfaces that its ray passes, opaque or not, between near and far plane: the
  /// depth complexity (checklist 6). Surfaces at the same depth count once; at most 255.
  [[nodiscard]] std::vector<std::uint8_t> count_surfaces(const View& view) const;

  /// Nearest surface at every pixel centre, opaque or not.
  void draw(const View& view, Frame& frame) const;

 private:
  struct Rays;
  std::unique_ptr<Rays> rays_;
};

/// Compares an answer with the truth; universes must be equal.
Verdict judge(const Truth& truth, const VisibleSet& visible);

}  // namespace sightline
