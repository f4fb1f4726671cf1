// The z-pyramid of Greene 1993 (checklist 5.01): level 0 is a depth image, each further level the farthest of n x n
// entries below. Promise of `hides`: true only if every pixel of the rectangle is nearer than the asked depth.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace sightline::raster {

struct PyramidLevel {
  int width = 0, height = 0;
  std::vector<float> farthest;
  [[nodiscard]] float at(int x, int y) const {
    return farthest[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
};

class DepthPyramid {
 public:
  /// `depth`: width * height distances, near is small; n >= 2 is the reduction of each level. Rounds sizes up.
  DepthPyramid(std::span<const float> depth, int width, int height, int n = 2);

  /// True if all pixels of [x0, x1) x [y0, y1) (not empty, within the image) hold surfaces nearer than `nearest`.
  /// Descends from the coarsest level only where that does not decide.
  [[nodiscard]] bool hides(int x0, int y0, int x1, int y1, float nearest) const;

  /// A pixel comes nearer: level 0 and, as far as the farthest value changes, the levels above.
  void update(int x, int y, float depth);

  [[nodiscard]] std::span<const PyramidLevel> levels() const { return levels_; }
  /// Entries looked at by `hides` so far.
  [[nodiscard]] std::size_t looked_at() const { return looked_at_; }

 private:
  [[nodiscard]] bool hides_below(std::size_t level, int x, int y, int x0, int y0, int x1, int y1, float nearest) const;
  [[nodiscard]] float reduce(std::size_t level, int x, int y) const;
  std::vector<PyramidLevel> levels_;
  int n_;
  mutable std::size_t looked_at_ = 0;
};

}  // namespace sightline::raster
