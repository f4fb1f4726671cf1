#include "sightline/raster/z_pyramid.hpp"

#include <algorithm>
#include <limits>

#include "sightline/raster/box_footprint.hpp"

namespace sightline {

struct ZPyramid::Query {
  int x0, y0, x1, y1;
  double nearest;
  int enough;
};

void ZPyramid::reset(int width, int height, int fan) {
  fan_ = fan;
  std::size_t count = 0;
  for (int w = width, h = height;; w = (w + fan - 1) / fan, h = (h + fan - 1) / fan) {
    if (levels_.size() <= count) levels_.emplace_back();
    Level& level = levels_[count++];
    level.width = w;
    level.height = h;
    level.depth.assign(static_cast<std::size_t>(w) * static_cast<std::size_t>(h),
                       std::numeric_limits<float>::infinity());
    if (w == 1 && h == 1) break;
  }
  levels_.resize(count);
}

float ZPyramid::at(int level, int x, int y) const {
  const Level& l = levels_[static_cast<std::size_t>(level)];
  return l.depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(l.width) + static_cast<std::size_t>(x)];
}

float& ZPyramid::pixel(int x, int y) {
  Level& l = levels_.front();
  return l.depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(l.width) + static_cast<std::size_t>(x)];
}

void ZPyramid::refresh(int x0, int y0, int x1, int y1) {
  for (std::size_t k = 1; k < levels_.size(); ++k) {
    const Level& below = levels_[k - 1];
    Level& level = levels_[k];
    x0 /= fan_;
    y0 /= fan_;
    x1 = (x1 + fan_ - 1) / fan_;
    y1 = (y1 + fan_ - 1) / fan_;
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) {
        float farthest = -std::numeric_limits<float>::infinity();
        for (int j = y * fan_; j < std::min((y + 1) * fan_, below.height); ++j)
          for (int i = x * fan_; i < std::min((x + 1) * fan_, below.width); ++i)
            farthest =
                std::max(farthest, below.depth[static_cast<std::size_t>(j) * static_cast<std::size_t>(below.width) +
                                               static_cast<std::size_t>(i)]);
        level.depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(level.width) + static_cast<std::size_t>(x)] =
            farthest;
      }
  }
}

void ZPyramid::descend(const Query& query, int level, int x, int y, int& open, std::uint64_t& cells) const {
  ++cells;
  if (behind(query.nearest, at(level, x, y))) return;
  if (level == 0) {
    ++open;
    return;
  }
  int size = 1;  // pixels of a cell one level down
  for (int k = 1; k < level; ++k) size *= fan_;
  const int left = std::max(x * fan_, query.x0 / size), right = std::min((x + 1) * fan_, (query.x1 - 1) / size + 1);
  const int top = std::max(y * fan_, query.y0 / size), bottom = std::min((y + 1) * fan_, (query.y1 - 1) / size + 1);
  for (int j = top; j < bottom; ++j)
    for (int i = left; i < right; ++i) {
      descend(query, level - 1, i, j, open, cells);
      if (open > query.enough) return;
    }
}

int ZPyramid::open_pixels(int x0, int y0, int x1, int y1, double nearest, int enough, std::uint64_t& cells) const {
  if (x0 >= x1 || y0 >= y1) return 0;
  // The finest level at which the rectangle touches at most two cells each way.
  int level = 0, size = 1;
  while (level + 1 < level_count() && ((x1 - 1) / size - x0 / size > 1 || (y1 - 1) / size - y0 / size > 1)) {
    ++level;
    size *= fan_;
  }
  const Query query{x0, y0, x1, y1, nearest, enough};
  int open = 0;
  for (int y = y0 / size; y <= (y1 - 1) / size; ++y)
    for (int x = x0 / size; x <= (x1 - 1) / size; ++x) {
      descend(query, level, x, y, open, cells);
      if (open > enough) return open;
    }
  return open;
}

}  // namespace sightline
