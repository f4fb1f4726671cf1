#include "sightline/cull/frustum_hierarchical.hpp"

#include <algorithm>
#include <bit>

#include "sightline/geometry/frustum_boxes.hpp"

namespace sightline {
namespace {

/// Subtrees with at most so many objects are tested object by object, a vector of them at once.
constexpr std::uint32_t few = 512;
constexpr std::uint32_t largest_leaf = 255;

class FrustumHierarchical final : public Culler {
 public:
  FrustumHierarchical(const IndexedScene& scene, bool corners)
      : indexed_(scene),
        scene_(scene.scene),
        bvh_(scene.bvh),
        reach_(reach(scene.scene.bounds())),
        corners_(corners),
        boxes_(bounds_in_tree_order(scene)),
        ranges_(item_ranges(bvh_)),
        last_plane_(bvh_.nodes.size(), 0),
        found_(std::max(few, largest_leaf) + 64) {
    for (const ObjectId id : bvh_.items) has_empty_ = has_empty_ || scene_.objects()[id].bounds.empty();
  }

  void cull(const View& view, const VisibleSet& candidates, VisibleSet& visible, Counters& counters) override {
    visible.reset(candidates.universe());
    if (bvh_.nodes.empty()) return;
    const Frustum frustum = view_frustum(view, reach_);
    const Aabb around = corners_ ? frustum_bounds(view) : Aabb();
    const bool all = candidates.is_all();
    stack_.assign(1, {0, (1u << frustum.count) - 1u});
    while (!stack_.empty()) {
      const auto [index, parent_planes] = stack_.back();
      stack_.pop_back();
      const BvhNode& node = bvh_.nodes[index];
      std::uint32_t planes = parent_planes;
      ++counters.nodes_visited;
      ++counters.boxes_tested;
      if (outside(frustum, node.bounds, planes, last_plane_[index])) continue;
      if (corners_ && planes != 0 && !node.bounds.overlaps(around)) {
        ++counters.corner_rejects;
        continue;
      }
      const ItemRange items = ranges_[index];
      if (planes == 0 && !has_empty_) {  // wholly inside: no more tests below
        take(items, all, candidates, visible);
        continue;
      }
      if (!node.leaf() && items.end - items.begin > few) {
        stack_.push_back({node.first + 1, planes});
        stack_.push_back({node.first, planes});
        continue;
      }
      counters.boxes_tested += items.end - items.begin;
      auto found =
          std::span(found_).first(boxes_in_frustum(boxes_, items.begin, items.end, frustum, planes, found_.data()));
      if (corners_) {
        const auto end = std::remove_if(found.begin(), found.end(), [&](auto item) { return misses(around, item); });
        counters.corner_rejects += static_cast<std::uint64_t>(found.end() - end);
        found = {found.begin(), end};
      }
      for (std::uint32_t& item : found) item = bvh_.items[item];  // from here on ids
      if (!all) {
        const auto end = std::remove_if(found.begin(), found.end(), [&](auto id) { return !candidates.contains(id); });
        found = {found.begin(), end};
      }
      visible.insert_new(found);
    }
  }

  bool follow_scene() override {  // whether a box is empty depends on its mesh alone
    boxes_ = BoxArrays(bounds_in_tree_order(indexed_));
    reach_ = reach(scene_.bounds());
    return true;
  }

  void reset() override { std::fill(last_plane_.begin(), last_plane_.end(), std::uint8_t{0}); }

 private:
  struct Visit {
    std::uint32_t node, planes;
  };

  void take(const ItemRange& items, bool all, const VisibleSet& candidates, VisibleSet& visible) const {
    if (all) {
      visible.insert_new(std::span(bvh_.items).subspan(items.begin, items.end - items.begin));
      return;
    }
    for (std::uint32_t i = items.begin; i < items.end; ++i)
      if (candidates.contains(bvh_.items[i])) visible.insert(bvh_.items[i]);
  }

  [[nodiscard]] bool misses(const Aabb& around, std::uint32_t item) const {
    for (int axis = 0; axis < 3; ++axis)
      if (boxes_.lo[axis][item] > around.hi[axis] || boxes_.hi[axis][item] < around.lo[axis]) return true;
    return false;
  }

  /// True if the box lies outside one of the planes of the mask; clears the planes that it lies wholly inside of. The
  /// plane that rejected the node last time is tried first.
  static bool outside(const Frustum& frustum, const Aabb& box, std::uint32_t& planes, std::uint8_t& last_plane) {
    if (planes == 0) return false;
    if (((planes >> last_plane) & 1u) != 0 && classify(frustum.planes[last_plane], box) == Containment::outside)
      return true;
    for (std::uint32_t left = planes; left != 0; left &= left - 1) {
      const int i = std::countr_zero(left);
      const Containment c = classify(frustum.planes[static_cast<std::size_t>(i)], box);
      if (c == Containment::outside) {
        last_plane = static_cast<std::uint8_t>(i);
        return true;
      }
      if (c == Containment::inside) planes &= ~(1u << i);
    }
    return false;
  }

  const IndexedScene& indexed_;
  const Scene& scene_;
  const Bvh& bvh_;
  double reach_;
  bool corners_, has_empty_ = false;
  BoxArrays boxes_;                       // of bvh_.items, in their order
  std::vector<ItemRange> ranges_;         // items below each node
  std::vector<std::uint8_t> last_plane_;  // per node: the plane that rejected it last
  std::vector<std::uint32_t> found_;
  std::vector<Visit> stack_;
};

}  // namespace

std::unique_ptr<Culler> make_frustum_hierarchical(const IndexedScene& scene, ParameterReader& parameters) {
  bool corners = false;
  parameters.read("corners", corners);
  parameters.finish();
  return std::make_unique<FrustumHierarchical>(scene, corners);
}

}  // namespace sightline
