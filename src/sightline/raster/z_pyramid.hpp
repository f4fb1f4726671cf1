// The z-pyramid of Greene, Kass and Miller 1993: over a depth image, level by level, the farthest depth of n x n cells,
// so that one comparison answers for a whole block. Checklist 5.17, 21.09. Depth is distance: near is small.
#pragma once

#include <cstdint>
#include <vector>

namespace sightline {

class ZPyramid {
 public:
  /// Sets the size (pixels, at least 1) and how many cells across and down make one of the next level (at least 2).
  /// All depths become infinite: nothing hides anything.
  void reset(int width, int height, int fan = 2);

  [[nodiscard]] int width() const { return levels_.front().width; }
  [[nodiscard]] int height() const { return levels_.front().height; }
  [[nodiscard]] int level_count() const { return static_cast<int>(levels_.size()); }
  [[nodiscard]] int level_width(int level) const { return levels_[static_cast<std::size_t>(level)].width; }
  [[nodiscard]] int level_height(int level) const { return levels_[static_cast<std::size_t>(level)].height; }
  /// Farthest depth of a cell; level 0 are the pixels.
  [[nodiscard]] float at(int level, int x, int y) const;
  /// The depth of a pixel, to be written; refresh() makes the levels above follow.
  float& pixel(int x, int y);
  /// Recomputes all cells above the pixels [x0, x1) x [y0, y1).
  void refresh(int x0, int y0, int x1, int y1);

  /// How many pixels of [x0, x1) x [y0, y1) are not in front of `nearest`: where something at that distance may be
  /// seen. Goes from coarse to fine and stops once it has found more than `enough`. Adds looked-at cells to `cells`.
  [[nodiscard]] int open_pixels(int x0, int y0, int x1, int y1, double nearest, int enough, std::uint64_t& cells) const;

 private:
  struct Level {
    int width, height;
    std::vector<float> depth;
  };
  struct Query;
  void descend(const Query& query, int level, int x, int y, int& open, std::uint64_t& cells) const;
  std::vector<Level> levels_;
  int fan_ = 2;
};

}  // namespace sightline
