#include "sightline/raster/depth_pyramid.hpp"

#include <algorithm>

namespace sightline::raster {

DepthPyramid::DepthPyramid(std::span<const float> depth, int width, int height, int n) : n_(std::max(n, 2)) {
  levels_.push_back({width, height, {depth.begin(), depth.end()}});
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    const int w = (levels_.back().width + n_ - 1) / n_, h = (levels_.back().height + n_ - 1) / n_;
    PyramidLevel next{w, h, std::vector<float>(static_cast<std::size_t>(w) * static_cast<std::size_t>(h))};
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) next.farthest[static_cast<std::size_t>(y * w + x)] = reduce(levels_.size() - 1, x, y);
    levels_.push_back(std::move(next));
  }
}

float DepthPyramid::reduce(std::size_t level, int x, int y) const {
  const PyramidLevel& below = levels_[level];
  float farthest = below.at(x * n_, y * n_);
  for (int j = y * n_; j < std::min(below.height, (y + 1) * n_); ++j)
    for (int i = x * n_; i < std::min(below.width, (x + 1) * n_); ++i) farthest = std::max(farthest, below.at(i, j));
  return farthest;
}

bool DepthPyramid::hides(int x0, int y0, int x1, int y1, float nearest) const {
  return hides_below(levels_.size() - 1, 0, 0, x0, y0, x1, y1, nearest);
}

bool DepthPyramid::hides_below(std::size_t level, int x, int y, int x0, int y0, int x1, int y1, float nearest) const {
  ++looked_at_;
  if (levels_[level].at(x, y) < nearest) return true;
  if (level == 0) return false;
  long long size = 1;  // pixels across an entry of the level below
  for (std::size_t i = 1; i < level; ++i) size *= n_;
  const PyramidLevel& below = levels_[level - 1];
  for (int j = y * n_; j < std::min(below.height, (y + 1) * n_); ++j)
    for (int i = x * n_; i < std::min(below.width, (x + 1) * n_); ++i) {
      if (i * size >= x1 || (i + 1) * size <= x0 || j * size >= y1 || (j + 1) * size <= y0) continue;
      if (!hides_below(level - 1, i, j, x0, y0, x1, y1, nearest)) return false;
    }
  return true;
}

void DepthPyramid::update(int x, int y, float depth) {
  levels_[0].farthest[static_cast<std::size_t>(y * levels_[0].width + x)] = depth;
  for (std::size_t level = 1; level < levels_.size(); ++level) {
    x /= n_;
    y /= n_;
    const float farthest = reduce(level - 1, x, y);
    float& stored = levels_[level].farthest[static_cast<std::size_t>(y * levels_[level].width + x)];
    if (stored == farthest) return;
    stored = farthest;
  }
}

}  // namespace sightline::raster
