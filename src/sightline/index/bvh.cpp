#include "sightline/index/bvh.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "sightline/index/morton_order.hpp"

namespace sightline {
namespace {

constexpr float nowhere = std::numeric_limits<float>::max();
constexpr int most_bins = 64;
constexpr std::size_t large = 16384;
constexpr std::uint32_t group_size = 64;

/// Four floats in one register (the compilers' generic vectors); the fourth means nothing.
using Float4 __attribute__((vector_size(16))) = float;
struct Vector {
  Float4 v;
};
inline Vector all(float x) { return {Float4{x, x, x, x}}; }
inline Vector min(const Vector& a, const Vector& b) { return {a.v < b.v ? a.v : b.v}; }
inline Vector max(const Vector& a, const Vector& b) { return {a.v > b.v ? a.v : b.v}; }

/// Empty boxes are [nowhere, -nowhere], so that their centre is 0 and they never widen anything.
struct Box {
  Vector lo = all(nowhere), hi = all(-nowhere);
  void extend(const Vector& low, const Vector& high) {
    lo = min(lo, low);
    hi = max(hi, high);
  }
  void extend_by(const Vector& point) { extend(point, point); }
  void extend(const Box& box) { extend(box.lo, box.hi); }
  [[nodiscard]] Aabb aabb() const {
    if (lo.v[0] > hi.v[0]) return {};
    return {{lo.v[0], lo.v[1], lo.v[2]}, {hi.v[0], hi.v[1], hi.v[2]}};
  }
  /// A quarter of the centre: sums and differences of the largest floats stay finite.
  [[nodiscard]] Vector centre() const { return {lo.v * 0.125f + hi.v * 0.125f}; }
  [[nodiscard]] float half_area() const {
    const Vector e{hi.v - lo.v};
    return e.v[0] < 0.0f ? 0.0f : e.v[0] * e.v[1] + e.v[1] * e.v[2] + e.v[2] * e.v[0];
  }
};

/// A range of boxes that becomes a node. `centres` bounds centre() of its boxes.
struct Range {
  std::uint32_t node, begin, end;
  Box bounds, centres;
};

struct Split {
  int axis = -1;
  int bin = 0;
  float cost = std::numeric_limits<float>::infinity();
};

class Builder {
 public:
  Builder(std::span<const Aabb> boxes, const BvhConfig& config) : config_(config), given_(boxes) {
    boxes_.reserve(boxes.size());
    ids_.reserve(boxes.size());
  }

  Bvh build() {
    if (given_.empty()) return {};
    bvh_.nodes.reserve(given_.size() + 1);
    bvh_.nodes.emplace_back();
    if (config_.grouped && given_.size() > large) {
      build_large();
    } else {
      for (std::uint32_t i = 0; i < given_.size(); ++i) take(i);
      subtree(whole(0, static_cast<std::uint32_t>(given_.size())));
    }
    bvh_.items = std::move(ids_);
    return std::move(bvh_);
  }

 private:
  void take(std::uint32_t id) {
    const Aabb& b = given_[id];
    ids_.push_back(id);
    boxes_.emplace_back();
    if (!b.empty()) boxes_.back() = {{Float4{b.lo.x, b.lo.y, b.lo.z, 0.0f}}, {Float4{b.hi.x, b.hi.y, b.hi.z, 0.0f}}};
  }

  /// Many boxes do not fit into the caches: neighbours are put together first, and the tree over groups of them ends
  /// where the trees of the groups begin.
  void build_large() {
    const auto [keys, runs, bounds] = morton_groups(given_, group_size);
    BvhConfig single = config_;
    single.max_leaf_size = 1;
    single.grouped = false;
    const Bvh top = Builder(bounds, single).build();
    struct Copy {
      std::uint32_t from, to;
    };
    std::vector<Copy> stack{{0, 0}};
    while (!stack.empty()) {
      const auto [from, to] = stack.back();
      stack.pop_back();
      const BvhNode& node = top.nodes[from];
      if (node.leaf()) {
        const MortonRun& run = runs[top.items[node.first]];
        const auto begin = static_cast<std::uint32_t>(boxes_.size());
        for (std::uint32_t i = run.begin; i < run.end; ++i) take(box_of(keys[i]));
        Range range = whole(begin, static_cast<std::uint32_t>(boxes_.size()));
        range.node = to;
        subtree(range);
        continue;
      }
      bvh_.nodes[to].bounds = node.bounds;
      const std::uint32_t left = add_children(to);
      stack.push_back({node.first + 1, left + 1});
      stack.push_back({node.first, left});
    }
  }

  std::uint32_t add_children(std::uint32_t node) {
    const auto left = static_cast<std::uint32_t>(bvh_.nodes.size());
    bvh_.nodes[node].first = left;
    bvh_.nodes.resize(bvh_.nodes.size() + 2);
    return left;
  }

  /// Without recursion: a chain of boxes must not exhaust the stack.
  void subtree(const Range& root) {
    stack_.assign(1, root);
    while (!stack_.empty()) {
      const Range range = stack_.back();
      stack_.pop_back();
      BvhNode& node = bvh_.nodes[range.node];
      node.bounds = range.bounds.aabb();
      if (range.end - range.begin <= static_cast<std::uint32_t>(config_.max_leaf_size)) {
        node.first = range.begin;
        node.count = range.end - range.begin;
        continue;
      }
      Range children[2];
      split(range, children);
      children[0].node = add_children(range.node);
      children[1].node = children[0].node + 1;
      stack_.push_back(children[1]);
      stack_.push_back(children[0]);
    }
  }

  void split(const Range& range, Range* children) {
    const std::uint32_t count = range.end - range.begin;
    bins_used_ = std::min(config_.bins, count > 64 ? most_bins : count > 16 ? 8 : 4);
    from_ = range.centres.lo;
    for (int axis = 0; axis < 3; ++axis) {
      const float extent = range.centres.hi.v[axis] - from_.v[axis];
      const float per_unit = static_cast<float>(bins_used_) / extent;
      per_unit_.v[axis] = extent > 0.0f && per_unit < nowhere ? per_unit : 0.0f;
    }
    const Split best = best_split(range);
    std::uint32_t middle = range.begin;
    if (best.axis >= 0) middle = partition(range, best, children);
    if (middle != range.begin && middle != range.end) return;
    // All centres coincide: anywhere is as good.
    middle = range.begin + count / 2;
    children[0] = whole(range.begin, middle);
    children[1] = whole(middle, range.end);
  }

  [[nodiscard]] Range whole(std::uint32_t begin, std::uint32_t end) const {
    Range range{0, begin, end, {}, {}};
    for (std::uint32_t i = begin; i < end; ++i) {
      const Vector centre = boxes_[i].centre();
      range.bounds.extend(boxes_[i]);
      range.centres.extend_by(centre);
    }
    return range;
  }

  [[nodiscard]] int bin_of(float centre, int axis) const {
    return std::min(static_cast<int>((centre - from_.v[axis]) * per_unit_.v[axis]), bins_used_ - 1);
  }

  /// Moves the left side's boxes to the front; returns where the right side begins.
  std::uint32_t partition(const Range& range, const Split& best, Range* children) {
    Box left_centres, right_centres, bounds[2];
    for (int b = 0; b < bins_used_; ++b) bounds[b > best.bin].extend(bins_[best.axis][b]);
    const int axis = best.axis;
    std::uint32_t left = range.begin, right = range.end;
    const auto goes_left = [&](const Box& box) {
      return bin_of(box.lo.v[axis] * 0.125f + box.hi.v[axis] * 0.125f, axis) <= best.bin;
    };
    while (true) {
      for (; left < right && goes_left(boxes_[left]); ++left) left_centres.extend_by(boxes_[left].centre());
      for (; left < right && !goes_left(boxes_[right - 1]); --right)
        right_centres.extend_by(boxes_[right - 1].centre());
      if (left >= right) break;
      --right;
      std::swap(boxes_[left], boxes_[right]);
      std::swap(ids_[left], ids_[right]);
      left_centres.extend_by(boxes_[left].centre());
      right_centres.extend_by(boxes_[right].centre());
      ++left;
    }
    children[0] = {0, range.begin, left, bounds[0], left_centres};
    children[1] = {0, left, range.end, bounds[1], right_centres};
    return left;
  }

  /// Surface area heuristic over the bins of all three axes, filled in one pass.
  Split best_split(const Range& range) {
    for (int axis = 0; axis < 3; ++axis) {
      std::fill_n(bins_[axis], bins_used_, Box());
      std::fill_n(counts_[axis], bins_used_, 0u);
    }
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      const Box box = boxes_[i];
      const Vector centre = box.centre();
      for (int axis = 0; axis < 3; ++axis) {
        const int b = bin_of(centre.v[axis], axis);
        bins_[axis][b].extend(box);
        ++counts_[axis][b];
      }
    }
    Split best;
    for (int axis = 0; axis < 3; ++axis)
      if (per_unit_.v[axis] > 0.0f) sweep(axis, best);
    return best;
  }

  /// Cost of splitting after each bin.
  void sweep(int axis, Split& best) const {
    const Box* bins = bins_[axis];
    const std::uint32_t* counts = counts_[axis];
    float right_cost[most_bins];
    Box right;
    std::uint32_t count = 0;
    for (int b = bins_used_ - 1; b > 0; --b) {
      right.extend(bins[b]);
      count += counts[b];
      right_cost[b] = count == 0 ? -1.0f : right.half_area() * static_cast<float>(count);
    }
    Box left;
    count = 0;
    for (int b = 0; b < bins_used_ - 1; ++b) {
      if (counts[b] == 0) continue;
      left.extend(bins[b]);
      count += counts[b];
      if (right_cost[b + 1] < 0.0f) break;
      const float cost = left.half_area() * static_cast<float>(count) + right_cost[b + 1];
      if (best.axis < 0 || cost < best.cost) best = {axis, b, cost};
    }
  }

  BvhConfig config_;
  std::span<const Aabb> given_;
  std::vector<Box> boxes_;
  std::vector<std::uint32_t> ids_;
  int bins_used_ = 0;
  Vector from_ = all(0.0f), per_unit_ = all(0.0f);
  Box bins_[3][most_bins];
  std::uint32_t counts_[3][most_bins];
  std::vector<Range> stack_;
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

std::vector<ItemRange> item_ranges(const Bvh& bvh) {
  std::vector<ItemRange> ranges(bvh.nodes.size());
  for (std::size_t i = ranges.size(); i-- > 0;) {  // children stand behind their parents
    const BvhNode& node = bvh.nodes[i];
    ranges[i] = node.leaf() ? ItemRange{node.first, node.first + node.count}
                            : ItemRange{ranges[node.first].begin, ranges[node.first + 1].end};
  }
  return ranges;
}

Bvh build_bvh(std::span<const Aabb> boxes, const BvhConfig& config) {
  assert(config.max_leaf_size >= 1 && config.bins >= 2 && config.bins <= most_bins);
  return Builder(boxes, config).build();
}

void refit(Bvh& bvh, std::span<const Aabb> boxes) {
  assert(boxes.size() == bvh.items.size());
  for (std::size_t i = bvh.nodes.size(); i-- > 0;) {  // children stand behind their parents
    BvhNode& node = bvh.nodes[i];
    node.bounds = {};
    if (node.leaf()) {
      for (std::uint32_t k = node.first; k < node.first + node.count; ++k)
        if (!boxes[bvh.items[k]].empty()) node.bounds.extend(boxes[bvh.items[k]]);
    } else {
      node.bounds.extend(bvh.nodes[node.first].bounds);
      node.bounds.extend(bvh.nodes[node.first + 1].bounds);
    }
  }
}

}  // namespace sightline
