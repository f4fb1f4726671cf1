#include "gl/tight_bounds.hpp"

#include <algorithm>

namespace sightline::gl {
namespace {

struct Part {
  std::uint32_t node;
  int depth;
};

/// Opens the part with the largest surface again and again while the sum stays within `most`. The surface is summed
/// over the boxes, inner faces that two of them share counted twice, because twice they are filled.
void split(const Bvh& bvh, std::uint32_t root, float most, int depth, std::vector<Part>& parts) {
  const auto area = [&](std::uint32_t n) { return bvh.nodes[n].bounds.half_area(); };
  parts.assign(1, {root, 0});
  float sum = area(root);
  std::vector<bool> final_part{false};
  for (;;) {
    std::size_t largest = parts.size();
    for (std::size_t i = 0; i < parts.size(); ++i) {
      if (final_part[i] || parts[i].depth == depth || bvh.nodes[parts[i].node].leaf()) continue;
      if (largest == parts.size() || area(parts[i].node) > area(parts[largest].node)) largest = i;
    }
    if (largest == parts.size()) return;
    const Part part = parts[largest];
    const std::uint32_t child = bvh.nodes[part.node].first;
    const float opened = sum - area(part.node) + area(child) + area(child + 1);
    if (opened > most) {
      final_part[largest] = true;
      continue;
    }
    sum = opened;
    parts[largest] = {child, part.depth + 1};
    parts.push_back({child + 1, part.depth + 1});
    final_part.push_back(false);
  }
}

}  // namespace

void TightBounds::build(const Bvh& bvh, const TightBoundsConfig& config) {
  boxes_.clear();
  first_.assign(1, 0);
  std::vector<Part> parts;
  for (std::uint32_t n = 0; n < bvh.nodes.size(); ++n) {
    const auto most = static_cast<float>(config.sigma) * bvh.nodes[n].bounds.half_area();
    split(bvh, n, most, config.sigma < 1.0 ? 0 : config.depth, parts);
    for (const Part& part : parts) boxes_.push_back(bvh.nodes[part.node].bounds);
    first_.push_back(static_cast<std::uint32_t>(boxes_.size()));
  }
}

}  // namespace sightline::gl
