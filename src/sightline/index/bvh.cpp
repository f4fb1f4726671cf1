#include "sightline/index/bvh.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <numeric>

namespace sightline {
namespace {

struct Range {
  std::uint32_t node, begin, end;
};

struct Split {
  int axis = -1;
  int bin = 0;
  float cost = std::numeric_limits<float>::infinity();
};

class Builder {
 public:
  Builder(std::span<const Aabb> boxes, const BvhConfig& config) : config_(config) {
    entries_.reserve(boxes.size());
    for (std::uint32_t i = 0; i < boxes.size(); ++i)
      entries_.push_back({boxes[i], boxes[i].empty() ? glm::vec3(0.0f) : boxes[i].centre(), i});
  }

  Bvh build() {
    if (entries_.empty()) return {};
    bvh_.nodes.reserve(2 * entries_.size());
    bvh_.nodes.emplace_back();
    // No recursion: a chain of boxes must not exhaust the stack.
    std::vector<Range> stack{{0, 0, static_cast<std::uint32_t>(entries_.size())}};
    while (!stack.empty()) {
      const Range range = stack.back();
      stack.pop_back();
      const std::uint32_t middle = make_node(range);
      if (middle == range.begin) continue;
      const auto left = static_cast<std::uint32_t>(bvh_.nodes.size());
      bvh_.nodes[range.node].first = left;
      bvh_.nodes.resize(bvh_.nodes.size() + 2);
      stack.push_back({left + 1, middle, range.end});
      stack.push_back({left, range.begin, middle});
    }
    bvh_.items.reserve(entries_.size());
    for (const Entry& entry : entries_) bvh_.items.push_back(entry.id);
    return std::move(bvh_);
  }

 private:
  struct Entry {
    Aabb box;
    glm::vec3 centre;
    std::uint32_t id;
  };
  struct Bin {
    Aabb box;
    std::uint32_t count = 0;
  };

  /// Fills the node's bounds; returns where to split its range, or range.begin for a leaf.
  std::uint32_t make_node(const Range& range) {
    Aabb bounds, centres;
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      bounds.extend(entries_[i].box);
      centres.extend(entries_[i].centre);
    }
    BvhNode& node = bvh_.nodes[range.node];
    node.bounds = bounds;
    const std::uint32_t count = range.end - range.begin;
    if (count <= static_cast<std::uint32_t>(config_.max_leaf_size)) {
      node.first = range.begin;
      node.count = count;
      return range.begin;
    }
    const Split split = best_split(range, centres);
    if (split.axis < 0) return range.begin + count / 2;  // all centroids coincide
    const auto first = entries_.begin() + range.begin, last = entries_.begin() + range.end;
    const auto middle =
        std::partition(first, last, [&](const Entry& e) { return bin_of(e.centre, centres, split.axis) <= split.bin; });
    return static_cast<std::uint32_t>(middle - entries_.begin());
  }

  int bin_of(const glm::vec3& centre, const Aabb& centres, int axis) const {
    const float extent = centres.hi[axis] - centres.lo[axis];
    const float place = (centre[axis] - centres.lo[axis]) / extent * static_cast<float>(config_.bins);
    return std::clamp(static_cast<int>(place), 0, config_.bins - 1);
  }

  Split best_split(const Range& range, const Aabb& centres) {
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      const float extent = centres.hi[axis] - centres.lo[axis];
      if (!(extent > 0.0f)) continue;
      bins_.fill({});
      for (std::uint32_t i = range.begin; i < range.end; ++i) {
        Bin& bin = bins_[static_cast<std::size_t>(bin_of(entries_[i].centre, centres, axis))];
        bin.box.extend(entries_[i].box);
        ++bin.count;
      }
      sweep(axis, best);
    }
    return best;
  }

  /// Surface area heuristic over the filled bins: cost of splitting after each bin.
  void sweep(int axis, Split& best) {
    const auto last = static_cast<std::size_t>(config_.bins) - 1;
    std::array<float, 64> right_cost{};
    Bin right;
    for (std::size_t b = last; b > 0; --b) {
      right.box.extend(bins_[b].box);
      right.count += bins_[b].count;
      right_cost[b] = right.count == 0 ? -1.0f : right.box.half_area() * static_cast<float>(right.count);
    }
    Bin left;
    for (std::size_t b = 0; b < last; ++b) {
      left.box.extend(bins_[b].box);
      left.count += bins_[b].count;
      if (left.count == 0 || right_cost[b + 1] < 0.0f) continue;
      const float cost = left.box.half_area() * static_cast<float>(left.count) + right_cost[b + 1];
      if (best.axis < 0 || cost < best.cost) best = {axis, static_cast<int>(b), cost};
    }
  }

  BvhConfig config_;
  std::vector<Entry> entries_;
  std::array<Bin, 64> bins_;
  Bvh bvh_;
};

}  // namespace

ItemRange items_below(const Bvh& bvh, std::uint32_t node) {
  const BvhNode* first = &bvh.nodes[node];
  const BvhNode* last = first;
  while (!first->leaf()) first = &bvh.nodes[first->first];
  while (!last->leaf()) last = &bvh.nodes[last->first + 1];
  return {first->first, last->first + last->count};
}

Bvh build_bvh(std::span<const Aabb> boxes, const BvhConfig& config) {
  assert(config.max_leaf_size >= 1 && config.bins >= 2 && config.bins <= 64);
  return Builder(boxes, config).build();
}

}  // namespace sightline
