#include "gl/method.hpp"

#include <algorithm>

namespace sightline::gl {

void Method::frame(const View& view, Target& target, const VisibleSet* candidates) {
  candidates_ = candidates != nullptr && candidates->is_all() ? nullptr : candidates;
  drawn_.clear();
  drawing_.begin(view, target);
  if (!drawing_.bvh().nodes.empty()) render();
  drawing_.context().check("a frame");
}

void Method::draw(std::span<const ObjectId> ids) {
  drawing_.draw(ids);
  drawn_.insert(drawn_.end(), ids.begin(), ids.end());
}

void objects_in_frustum(SceneDrawing& drawing, const VisibleSet* candidates, bool sorted, std::vector<Placed>& found) {
  found.clear();
  const Bvh& bvh = drawing.bvh();
  if (bvh.nodes.empty()) return;
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    const std::uint32_t n = stack.back();
    const BvhNode& node = bvh.nodes[n];
    stack.pop_back();
    ++drawing.work().nodes;
    const Containment where = classify(drawing.frustum(), node.bounds);
    if (where == Containment::outside) continue;
    if (where == Containment::inside || node.leaf()) {
      const ItemRange range = items_below(bvh, n);
      for (std::uint32_t i = range.begin; i < range.end; ++i) {
        const ObjectId id = bvh.items[i];
        if (candidates != nullptr && !candidates->contains(id)) continue;
        if (range.end - range.begin > 1 || where == Containment::inside ||
            classify(drawing.frustum(), drawing.bounds()[id]) != Containment::outside)
          found.push_back({sorted ? drawing.distance2(drawing.bounds()[id]) : 0.0f, id});
      }
      continue;
    }
    stack.push_back(node.first + 1);
    stack.push_back(node.first);
  }
  const auto nearer = [](const Placed& a, const Placed& b) {
    return a.distance2 != b.distance2 ? a.distance2 < b.distance2 : a.id < b.id;
  };
  if (sorted) std::sort(found.begin(), found.end(), nearer);
}

}  // namespace sightline::gl
