#include "sightline/index/bvh_builders.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <vector>

namespace sightline {
namespace {

/// Where a range of items is cut; in between begin and end, or begin for a leaf.
using Cut = std::uint32_t;

struct Range {
  std::uint32_t node, begin, end;
};

/// Top-down over items with centroids; `cut(begin, end, centres, items)` reorders a range and says where it is cut.
template <class CutAt>
Bvh build_top_down(std::span<const Aabb> boxes, const BvhConfig& config, CutAt&& cut) {
  assert(config.max_leaf_size >= 1 && config.max_leaf_size <= 255);
  Bvh bvh;
  if (boxes.empty()) return bvh;
  std::vector<glm::vec3> centres;
  centres.reserve(boxes.size());
  for (const Aabb& box : boxes) centres.push_back(box.empty() ? glm::vec3(0.0f) : box.centre());
  bvh.items.resize(boxes.size());
  std::iota(bvh.items.begin(), bvh.items.end(), 0u);
  bvh.nodes.emplace_back();
  std::vector<Range> stack{{0, 0, static_cast<std::uint32_t>(boxes.size())}};
  while (!stack.empty()) {
    const Range range = stack.back();
    stack.pop_back();
    Aabb bounds;
    for (std::uint32_t i = range.begin; i < range.end; ++i) bounds.extend(boxes[bvh.items[i]]);
    const std::uint32_t count = range.end - range.begin;
    bvh.nodes[range.node].bounds = bounds;
    if (count <= static_cast<std::uint32_t>(config.max_leaf_size)) {
      bvh.nodes[range.node].first = range.begin;
      bvh.nodes[range.node].count = count;
      continue;
    }
    std::uint32_t middle = cut(range.begin, range.end, bounds, centres, bvh.items);
    if (middle <= range.begin || middle >= range.end) middle = range.begin + count / 2;
    const auto left = static_cast<std::uint32_t>(bvh.nodes.size());
    bvh.nodes[range.node].first = left;
    bvh.nodes.resize(bvh.nodes.size() + 2);
    stack.push_back({left + 1, middle, range.end});
    stack.push_back({left, range.begin, middle});
  }
  return bvh;
}

int longest_axis(const Aabb& box) {
  const glm::vec3 e = box.extent();
  return e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
}

}  // namespace

Bvh build_bvh_extent(std::span<const Aabb> boxes, const BvhConfig& config) {
  return build_top_down(boxes, config,
                        [](std::uint32_t begin, std::uint32_t end, const Aabb& bounds,
                           const std::vector<glm::vec3>& centres, std::vector<std::uint32_t>& items) -> Cut {
                          const int axis = longest_axis(bounds);
                          const float middle = bounds.centre()[axis];
                          const auto first = items.begin() + begin, last = items.begin() + end;
                          const auto at = std::partition(
                              first, last, [&](std::uint32_t item) { return centres[item][axis] < middle; });
                          return static_cast<Cut>(at - items.begin());
                        });
}

Bvh build_bvh_median(std::span<const Aabb> boxes, const BvhConfig& config) {
  return build_top_down(boxes, config,
                        [](std::uint32_t begin, std::uint32_t end, const Aabb&, const std::vector<glm::vec3>& centres,
                           std::vector<std::uint32_t>& items) -> Cut {
                          Aabb spread;
                          for (std::uint32_t i = begin; i < end; ++i) spread.extend(centres[items[i]]);
                          const int axis = longest_axis(spread);
                          const Cut middle = begin + (end - begin) / 2;
                          std::nth_element(items.begin() + begin, items.begin() + middle, items.begin() + end,
                                           [&](std::uint32_t a, std::uint32_t b) {
                                             const float ca = centres[a][axis], cb = centres[b][axis];
                                             return ca < cb || (ca == cb && a < b);
                                           });
                          return middle;
                        });
}

}  // namespace sightline
