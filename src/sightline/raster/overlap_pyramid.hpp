// The overlap half of hierarchical occlusion maps (Zhang, Manocha, Hudson, Hoff 1997; checklist 5.18): how much of
// every pixel block the occluders cover, level by level, averaged over 2 x 2. Opacities are ratios of whole numbers, so
// 1 means covered without exception.
#pragma once

#include <cstdint>
#include <vector>

namespace sightline {

class OverlapPyramid {
 public:
  /// Sets the size in pixels (at least 1); nothing is covered.
  void reset(int width, int height);
  [[nodiscard]] int level_count() const { return static_cast<int>(levels_.size()); }
  [[nodiscard]] int level_width(int level) const { return levels_[static_cast<std::size_t>(level)].width; }
  [[nodiscard]] int level_height(int level) const { return levels_[static_cast<std::size_t>(level)].height; }
  void cover(int x, int y) { levels_.front().covered[index(levels_.front(), x, y)] = 1; }
  [[nodiscard]] bool covered(int x, int y) const { return levels_.front().covered[index(levels_.front(), x, y)] != 0; }
  /// Makes the levels above follow the pixels.
  void build();
  /// Covered share of a cell's pixels, 0 to 1. Pixels beyond the image do not count.
  [[nodiscard]] double opacity(int level, int x, int y) const;

  /// What counts as opaque. `opacity`: at least this share (1: every pixel). `holes`: a cell of n pixels may have that
  /// many open ones, the paper's threshold 1 - holes / n, if n is at least 4 holes; 0 for none.
  struct Threshold {
    double opacity = 1.0;
    double holes = 0.0;
  };
  /// True if every cell that [x0, x1) x [y0, y1) touches is opaque at some level from coarse to fine. Conservative for
  /// the default threshold. Adds looked-at cells to `cells`.
  [[nodiscard]] bool covers(int x0, int y0, int x1, int y1, const Threshold& threshold, std::uint64_t& cells) const;

 private:
  struct Level {
    int width, height;
    std::vector<std::uint32_t> covered;
  };
  static std::size_t index(const Level& level, int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(level.width) + static_cast<std::size_t>(x);
  }
  [[nodiscard]] double pixels_of(int level, int x, int y) const;
  [[nodiscard]] bool opaque(int level, int x, int y, const Threshold& threshold) const;
  std::vector<Level> levels_;
};

}  // namespace sightline
