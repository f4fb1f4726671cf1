#include "sightline/cull/frustum_hierarchical.hpp"

namespace sightline {
namespace {

class FrustumHierarchical final : public Culler {
 public:
  explicit FrustumHierarchical(const IndexedScene& scene) : bvh_(scene.bvh), reach_(reach(scene.scene.bounds())) {
    boxes_.reserve(bvh_.items.size());
    for (const ObjectId id : bvh_.items) boxes_.push_back(scene.scene.objects()[id].bounds);
  }

  void cull(const View& view, const VisibleSet& candidates, VisibleSet& visible, Counters& counters) override {
    visible.reset(candidates.universe());
    if (bvh_.nodes.empty()) return;
    const Frustum frustum = view_frustum(view, reach_);
    const bool all = candidates.is_all();
    stack_.assign(1, {0, (1u << frustum.count) - 1u});
    while (!stack_.empty()) {
      const auto [index, parent_planes] = stack_.back();
      stack_.pop_back();
      const BvhNode& node = bvh_.nodes[index];
      std::uint32_t planes = parent_planes;
      ++counters.nodes_visited;
      if (outside(frustum, node.bounds, planes, counters)) continue;
      if (planes != 0 && !node.leaf()) {
        stack_.push_back({node.first + 1, planes});
        stack_.push_back({node.first, planes});
        continue;
      }
      const ItemRange items = items_below(bvh_, index);  // wholly inside: no more tests below
      for (std::uint32_t i = items.begin; i < items.end; ++i) {
        const ObjectId id = bvh_.items[i];
        std::uint32_t object_planes = planes;
        if ((all || candidates.contains(id)) && !boxes_[i].empty() &&
            !outside(frustum, boxes_[i], object_planes, counters))
          visible.insert(id);
      }
    }
  }

 private:
  struct Visit {
    std::uint32_t node, planes;
  };

  /// True if the box lies outside one of the planes of the mask; clears the planes that it lies wholly inside of.
  static bool outside(const Frustum& frustum, const Aabb& box, std::uint32_t& planes, Counters& counters) {
    if (planes == 0) return false;
    ++counters.boxes_tested;
    for (int i = 0; i < frustum.count; ++i) {
      if (((planes >> i) & 1u) == 0) continue;
      const Containment c = classify(frustum.planes[static_cast<std::size_t>(i)], box);
      if (c == Containment::outside) return true;
      if (c == Containment::inside) planes &= ~(1u << i);
    }
    return false;
  }

  const Bvh& bvh_;
  double reach_;
  std::vector<Aabb> boxes_;  // of bvh_.items, in their order
  std::vector<Visit> stack_;
};

}  // namespace

std::unique_ptr<Culler> make_frustum_hierarchical(const IndexedScene& scene, ParameterReader& parameters) {
  parameters.finish();
  return std::make_unique<FrustumHierarchical>(scene);
}

}  // namespace sightline
