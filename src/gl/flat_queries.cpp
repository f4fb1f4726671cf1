#include "gl/flat_queries.hpp"

#include <algorithm>

#include "gl/queries.hpp"

namespace sightline::gl {
namespace {

/// What the methods share: the objects in the frustum, nearest first, and bundles of queries about them.
class FlatMethod : public Method {
 public:
  FlatMethod(SceneDrawing& drawing, int threshold)
      : Method(drawing), queries_(drawing, static_cast<std::uint32_t>(threshold)) {}

  [[nodiscard]] bool approximate() const override { return queries_.approximate(); }

 protected:
  const std::vector<Placed>& find() {
    objects_in_frustum(drawing_, candidates(), true, found_);
    return found_;
  }

  /// Queries all of `ids`, waits once, and draws those that are seen.
  void ask_and_draw(std::span<const ObjectId> ids) {
    if (ids.empty()) return;
    boxes_.clear();
    for (const ObjectId id : ids) boxes_.push_back(drawing_.bounds()[id]);
    const std::vector<OcclusionQueries::Ask> asks(ids.size(), {1, 1});
    names_.clear();
    queries_.issue(boxes_, asks, names_);
    seen_.clear();
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const bool seen = i == 0 ? queries_.seen_now(names_[i]) : queries_.seen(names_[i]);
      if (seen) seen_.push_back(ids[i]);
      if (log_ != nullptr)
        *log_ += std::to_string(drawing_.work().frames) + " object " + std::to_string(ids[i]) +
                 (seen ? " seen\n" : " hidden\n");
    }
    draw(seen_);
  }

 private:
  OcclusionQueries queries_;
  std::vector<Placed> found_;
  std::vector<Aabb> boxes_;
  std::vector<unsigned> names_;
  std::vector<ObjectId> seen_;
};

/// Test, wait, draw or cull; down the hierarchy, so that what is hidden together is asked about together.
class StopAndWait final : public FlatMethod {
 public:
  StopAndWait(SceneDrawing& drawing, bool hierarchy, int threshold)
      : FlatMethod(drawing, threshold),
        hierarchy_(hierarchy),
        queries_(drawing, static_cast<std::uint32_t>(threshold)) {}

 private:
  void render() override {
    if (!hierarchy_) {
      for (const Placed& placed : find()) {
        if (drawing_.near_or_inside(drawing_.bounds()[placed.id]))
          draw({&placed.id, 1});
        else
          ask_and_draw({&placed.id, 1});
      }
      return;
    }
    const Bvh& bvh = drawing_.bvh();
    std::vector<std::uint32_t> stack{0};
    while (!stack.empty()) {
      const std::uint32_t n = stack.back();
      const BvhNode& node = bvh.nodes[n];
      stack.pop_back();
      ++drawing_.work().nodes;
      if (classify(drawing_.frustum(), node.bounds) == Containment::outside) continue;
      if (!drawing_.near_or_inside(node.bounds) && !seen(n)) continue;
      if (node.leaf()) {
        for (std::uint32_t i = 0; i < node.count; ++i)
          if (const ObjectId id = bvh.items[node.first + i]; is_candidate(id)) draw({&id, 1});
        continue;
      }
      const bool left_is_nearer =
          drawing_.distance2(bvh.nodes[node.first].bounds) <= drawing_.distance2(bvh.nodes[node.first + 1].bounds);
      stack.push_back(node.first + (left_is_nearer ? 1 : 0));
      stack.push_back(node.first + (left_is_nearer ? 0 : 1));
    }
  }

  bool seen(std::uint32_t n) {
    const OcclusionQueries::Ask ask{1, 1};
    names_.clear();
    queries_.issue({&drawing_.bvh().nodes[n].bounds, 1}, {&ask, 1}, names_);
    const bool answer = queries_.seen_now(names_[0]);
    if (log_ != nullptr)
      *log_ +=
          std::to_string(drawing_.work().frames) + " node " + std::to_string(n) + (answer ? " seen\n" : " hidden\n");
    return answer;
  }

  bool hierarchy_;
  OcclusionQueries queries_;
  std::vector<unsigned> names_;
};

/// Sort, draw some objects to have occluders at all (E45), query all others in one bundle, then read and draw.
class DrawAndWait final : public FlatMethod {
 public:
  DrawAndWait(SceneDrawing& drawing, double first, int threshold) : FlatMethod(drawing, threshold), first_(first) {}

 private:
  void render() override {
    const std::vector<Placed>& found = find();
    const auto first = static_cast<std::size_t>(first_ * static_cast<double>(found.size()));
    std::vector<ObjectId> now, later;
    for (std::size_t i = 0; i < found.size(); ++i)
      (i < first || drawing_.near_or_inside(drawing_.bounds()[found[i].id]) ? now : later).push_back(found[i].id);
    draw(now);
    ask_and_draw(later);
  }
  double first_;
};

/// Bundles of so many objects, nearest first: within a bundle nothing is known of each other, but nobody stalls.
class MultipleQueries final : public FlatMethod {
 public:
  MultipleQueries(SceneDrawing& drawing, int bundle, int threshold)
      : FlatMethod(drawing, threshold), bundle_(static_cast<std::size_t>(bundle)) {}

 private:
  void render() override {
    std::vector<ObjectId> bundle;
    for (const Placed& placed : find()) {
      if (drawing_.near_or_inside(drawing_.bounds()[placed.id])) {
        draw({&placed.id, 1});
        continue;
      }
      bundle.push_back(placed.id);
      if (bundle.size() < bundle_) continue;
      ask_and_draw(bundle);
      bundle.clear();
    }
    ask_and_draw(bundle);
  }
  std::size_t bundle_;
};

/// A coarse image of which tiles the boxes of a bundle touch: what is not touched cannot overlap.
class OccupancyMap {
 public:
  static constexpr int width = 64, height = 36;
  struct Rect {
    int x0, y0, x1, y1;  // inclusive
  };

  /// Tiles that the projection of a box may touch.
  static Rect rect_of(const glm::dmat4& clip, const Aabb& box) {
    double x0 = 1e300, x1 = -1e300, y0 = 1e300, y1 = -1e300;
    for (int i = 0; i < 8; ++i) {
      const glm::dvec4 p = clip * glm::dvec4(box.corner(i), 1.0);
      if (p.w <= 0.0) return {0, 0, width - 1, height - 1};
      x0 = std::min(x0, p.x / p.w);
      x1 = std::max(x1, p.x / p.w);
      y0 = std::min(y0, p.y / p.w);
      y1 = std::max(y1, p.y / p.w);
    }
    const auto tile = [](double v, int tiles) {
      return static_cast<int>(std::clamp((0.5 + 0.5 * v) * tiles, 0.0, tiles - 1.0));
    };
    return {tile(x0 - 0.002, width), tile(y0 - 0.002, height), tile(x1 + 0.002, width), tile(y1 + 0.002, height)};
  }

  void clear() { rows_.fill(0); }
  [[nodiscard]] bool touches(const Rect& r) const {
    for (int y = r.y0; y <= r.y1; ++y)
      if ((rows_[static_cast<std::size_t>(y)] & mask(r)) != 0) return true;
    return false;
  }
  void add(const Rect& r) {
    for (int y = r.y0; y <= r.y1; ++y) rows_[static_cast<std::size_t>(y)] |= mask(r);
  }

 private:
  static std::uint64_t mask(const Rect& r) { return (~std::uint64_t{0} << r.x0) & (~std::uint64_t{0} >> (63 - r.x1)); }
  std::array<std::uint64_t, height> rows_{};
};

/// Bundles of objects that do not overlap on the screen: no answer of a bundle could have helped another of it. The
/// first bundle has nothing before it and is drawn without a query.
class OverlapFree final : public FlatMethod {
 public:
  OverlapFree(SceneDrawing& drawing, int largest, int threshold)
      : FlatMethod(drawing, threshold), largest_(static_cast<std::size_t>(largest)) {}

 private:
  void render() override {
    const glm::dmat4 clip = view_projection(drawing_.view());
    std::vector<ObjectId> left, next, bundle;
    std::vector<OccupancyMap::Rect> rects, next_rects;
    for (const Placed& placed : find()) {
      if (drawing_.near_or_inside(drawing_.bounds()[placed.id])) {
        draw({&placed.id, 1});
        continue;
      }
      left.push_back(placed.id);
      rects.push_back(OccupancyMap::rect_of(clip, drawing_.bounds()[placed.id]));
    }
    for (bool first = drawn_.empty(); !left.empty(); first = false) {
      next.clear();
      next_rects.clear();
      bundle.clear();
      map_.clear();
      for (std::size_t i = 0; i < left.size(); ++i) {
        const bool free = bundle.size() < largest_ && !map_.touches(rects[i]);
        map_.add(rects[i]);  // of those put off as well: they are nearer than what follows
        if (free) {
          bundle.push_back(left[i]);
        } else {
          next.push_back(left[i]);
          next_rects.push_back(rects[i]);
        }
      }
      if (first)
        draw(bundle);
      else
        ask_and_draw(bundle);
      left.swap(next);
      rects.swap(next_rects);
    }
  }
  std::size_t largest_;
  OccupancyMap map_;
};

int read_threshold(ParameterReader& parameters) {
  int threshold = 1;
  parameters.read("threshold", threshold, 1, 1 << 24);
  return threshold;
}

}  // namespace

std::unique_ptr<Method> make_stop_and_wait(SceneDrawing& drawing, ParameterReader& parameters) {
  bool hierarchy = true;
  parameters.read("hierarchy", hierarchy);
  const int threshold = read_threshold(parameters);
  parameters.finish();
  return std::make_unique<StopAndWait>(drawing, hierarchy, threshold);
}

std::unique_ptr<Method> make_draw_and_wait(SceneDrawing& drawing, ParameterReader& parameters) {
  double first = 0.1;
  parameters.read("first", first, 0.0, 1.0);
  const int threshold = read_threshold(parameters);
  parameters.finish();
  return std::make_unique<DrawAndWait>(drawing, first, threshold);
}

std::unique_ptr<Method> make_multiple_queries(SceneDrawing& drawing, ParameterReader& parameters) {
  int bundle = 50;
  parameters.read("bundle", bundle, 1, 1 << 20);
  const int threshold = read_threshold(parameters);
  parameters.finish();
  return std::make_unique<MultipleQueries>(drawing, bundle, threshold);
}

std::unique_ptr<Method> make_overlap_free(SceneDrawing& drawing, ParameterReader& parameters) {
  int largest = 1 << 20;
  parameters.read("largest", largest, 1, 1 << 20);
  const int threshold = read_threshold(parameters);
  parameters.finish();
  return std::make_unique<OverlapFree>(drawing, largest, threshold);
}

}  // namespace sightline::gl
