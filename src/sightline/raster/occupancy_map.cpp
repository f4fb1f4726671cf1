#include "sightline/raster/occupancy_map.hpp"

#include <algorithm>

namespace sightline {

void OccupancyMap::reset(int width, int height) {
  std::size_t count = 0;
  for (int w = width, h = height, below_w = 0, below_h = 0;; w = (w + fan - 1) / fan, h = (h + fan - 1) / fan) {
    if (levels_.size() <= count) levels_.emplace_back();
    Level& level = levels_[count];
    level.width = w;
    level.height = h;
    level.open.assign(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), count == 0 ? 1 : fan * fan);
    if (count > 0)  // cells at the border hold fewer
      for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x)
          level.open[index(level, x, y)] = static_cast<std::uint8_t>((std::min((x + 1) * fan, below_w) - x * fan) *
                                                                     (std::min((y + 1) * fan, below_h) - y * fan));
    ++count;
    if (w == 1 && h == 1) break;
    below_w = w;
    below_h = h;
  }
  levels_.resize(count);
}

bool OccupancyMap::full(int level, int x, int y) const {
  const Level& l = levels_[static_cast<std::size_t>(level)];
  return l.open[index(l, x, y)] == 0;
}

void OccupancyMap::occupy(int x, int y) {
  for (Level& level : levels_) {
    std::uint8_t& open = level.open[index(level, x, y)];
    if (open == 0 || --open > 0) return;
    x /= fan;
    y /= fan;
  }
}

bool OccupancyMap::covers(int x0, int y0, int x1, int y1, std::uint64_t& cells) const {
  if (x0 >= x1 || y0 >= y1) return true;
  int start = 0, size = 1;
  while (start + 1 < level_count() && ((x1 - 1) / size - x0 / size > 1 || (y1 - 1) / size - y0 / size > 1)) {
    ++start;
    size *= fan;
  }
  const auto covered = [&](const auto& self, int level, int span, int x, int y) -> bool {
    ++cells;
    if (full(level, x, y)) return true;
    if (level == 0) return false;
    const int below = span / fan;
    for (int j = std::max(fan * y, y0 / below); j <= std::min(fan * y + fan - 1, (y1 - 1) / below); ++j)
      for (int i = std::max(fan * x, x0 / below); i <= std::min(fan * x + fan - 1, (x1 - 1) / below); ++i)
        if (!self(self, level - 1, below, i, j)) return false;
    return true;
  };
  for (int y = y0 / size; y <= (y1 - 1) / size; ++y)
    for (int x = x0 / size; x <= (x1 - 1) / size; ++x)
      if (!covered(covered, start, size, x, y)) return false;
  return true;
}

}  // namespace sightline
