#include "sightline/raster/overlap_pyramid.hpp"

#include <algorithm>

namespace sightline {

void OverlapPyramid::reset(int width, int height) {
  std::size_t count = 0;
  for (int w = width, h = height;; w = (w + 1) / 2, h = (h + 1) / 2) {
    if (levels_.size() <= count) levels_.emplace_back();
    Level& level = levels_[count++];
    level.width = w;
    level.height = h;
    level.covered.assign(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), 0);
    if (w == 1 && h == 1) break;
  }
  levels_.resize(count);
}

void OverlapPyramid::build() {
  for (std::size_t k = 1; k < levels_.size(); ++k) {
    const Level& below = levels_[k - 1];
    Level& level = levels_[k];
    for (int y = 0; y < level.height; ++y)
      for (int x = 0; x < level.width; ++x) {
        std::uint32_t sum = 0;
        for (int j = 2 * y; j < std::min(2 * y + 2, below.height); ++j)
          for (int i = 2 * x; i < std::min(2 * x + 2, below.width); ++i) sum += below.covered[index(below, i, j)];
        level.covered[index(level, x, y)] = sum;
      }
  }
}

double OverlapPyramid::pixels_of(int level, int x, int y) const {
  const int size = 1 << level;
  const int across = std::min((x + 1) * size, levels_.front().width) - x * size;
  const int down = std::min((y + 1) * size, levels_.front().height) - y * size;
  return static_cast<double>(across) * down;
}

double OverlapPyramid::opacity(int level, int x, int y) const {
  const Level& l = levels_[static_cast<std::size_t>(level)];
  return l.covered[index(l, x, y)] / pixels_of(level, x, y);
}

bool OverlapPyramid::opaque(int level, int x, int y, const Threshold& threshold) const {
  const Level& l = levels_[static_cast<std::size_t>(level)];
  const double pixels = pixels_of(level, x, y);
  double enough = threshold.opacity * pixels;
  if (pixels >= 4 * threshold.holes) enough = std::min(enough, pixels - threshold.holes);
  return l.covered[index(l, x, y)] >= enough;
}

bool OverlapPyramid::covers(int x0, int y0, int x1, int y1, const Threshold& threshold, std::uint64_t& cells) const {
  if (x0 >= x1 || y0 >= y1) return true;
  int start = 0;
  while (start + 1 < level_count() &&
         (((x1 - 1) >> start) - (x0 >> start) > 1 || ((y1 - 1) >> start) - (y0 >> start) > 1))
    ++start;
  const auto covered = [&](const auto& self, int level, int x, int y) -> bool {
    ++cells;
    if (opaque(level, x, y, threshold)) return true;
    if (level == 0) return false;
    const int below = level - 1;
    for (int j = std::max(2 * y, y0 >> below); j <= std::min(2 * y + 1, (y1 - 1) >> below); ++j)
      for (int i = std::max(2 * x, x0 >> below); i <= std::min(2 * x + 1, (x1 - 1) >> below); ++i)
        if (!self(self, below, i, j)) return false;
    return true;
  };
  for (int y = y0 >> start; y <= (y1 - 1) >> start; ++y)
    for (int x = x0 >> start; x <= (x1 - 1) >> start; ++x)
      if (!covered(covered, start, x, y)) return false;
  return true;
}

}  // namespace sightline
