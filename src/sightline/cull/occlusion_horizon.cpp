#include "sightline/cull/occlusion_horizon.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "sightline/parallel/parallel.hpp"
#include "sightline/raster/horizon.hpp"
#include "sightline/scene/input_error.hpp"

namespace sightline {
namespace {

/// The fences of every opaque object: found once for each mesh and linear map, then moved to where the object stands.
class SceneFences {
 public:
  explicit SceneFences(const Scene& scene) : set_of_(scene.objects().size(), none) {
    std::vector<ObjectId> order;
    for (ObjectId id = 0; id < scene.objects().size(); ++id)
      if (scene.objects()[id].opaque && !scene.objects()[id].bounds.empty()) order.push_back(id);
    const auto key = [&](ObjectId id) {
      const Object& o = scene.objects()[id];
      std::array<float, 9> k{};
      for (int i = 0; i < 9; ++i) k[static_cast<std::size_t>(i)] = o.transform[i / 3][i % 3];
      return std::pair(o.mesh, k);
    };
    std::stable_sort(order.begin(), order.end(), [&](ObjectId a, ObjectId b) { return key(a) < key(b); });
    std::vector<ObjectId> first;
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (i == 0 || key(order[i]) != key(order[i - 1])) first.push_back(order[i]);
      set_of_[order[i]] = static_cast<std::uint32_t>(first.size() - 1);
    }
    sets_.resize(first.size());
    parallel_blocks(first.size(), 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Object& o = scene.objects()[first[i]];
        sets_[i] = find_wall_fences(scene.meshes()[o.mesh], glm::dmat3(to_matrix(o.transform)));
      }
    });
  }

  /// nullptr if the object has no wall.
  [[nodiscard]] const WallFences* of(ObjectId id) const {
    if (set_of_[id] == none || sets_[set_of_[id]].fences.empty()) return nullptr;
    return &sets_[set_of_[id]];
  }

 private:
  static constexpr std::uint32_t none = 0xFFFFFFFFu;
  std::vector<std::uint32_t> set_of_;
  std::vector<WallFences> sets_;
};

class OcclusionHorizon final : public Culler {
 public:
  OcclusionHorizon(const IndexedScene& scene, int columns, bool boxes)
      : scene_(scene.scene), bvh_(scene.bvh), columns_(columns), boxes_(boxes), reach_(reach(scene.scene.bounds())) {
    if (!boxes) fences_ = std::make_unique<SceneFences>(scene.scene);
  }

  void cull(const View& view, const VisibleSet& candidates, VisibleSet& visible, Counters& counters) override {
    visible.reset(candidates.universe());
    if (bvh_.nodes.empty()) return;
    frustum_ = view_frustum(view, reach_);
    usable_ = horizon_.begin(view, columns_);
    all_ = candidates.is_all();
    open_.clear();
    pending_.clear();
    added_ = -std::numeric_limits<double>::infinity();
    open_.push_back({-std::numeric_limits<float>::infinity(),
                     0,
                     {},
                     static_cast<std::uint16_t>((1u << frustum_.count) - 1u),
                     false});
    while (!open_.empty()) {
      std::pop_heap(open_.begin(), open_.end(), farther);
      const Entry entry = open_.back();
      open_.pop_back();
      add_walls_before(entry.nearest, counters);
      if (entry.object)
        take_object(entry, visible, counters);
      else
        take_node(entry, candidates, counters);
    }
  }

  [[nodiscard]] bool approximate() const override { return boxes_; }

 private:
  struct Entry {
    float nearest;  // plan distance, rounded towards the eye
    std::uint32_t index;
    HorizonQuery asks;     // whether it is hidden
    std::uint16_t planes;  // of the frustum that are still to be tested, one bit each
    bool object;
  };
  struct Pending {
    float farthest;  // plan distance, rounded away from the eye
    ObjectId id;
  };
  static bool farther(const Entry& a, const Entry& b) {
    if (a.nearest != b.nearest) return a.nearest > b.nearest;
    return a.object != b.object ? a.object < b.object : a.index > b.index;
  }
  static bool later(const Pending& a, const Pending& b) {
    return a.farthest != b.farthest ? a.farthest > b.farthest : a.id > b.id;
  }

  static bool outside(const Frustum& frustum, const Aabb& box, std::uint32_t& planes) {
    for (int i = 0; i < frustum.count && planes != 0; ++i) {
      if (((planes >> i) & 1u) == 0) continue;
      const Containment c = classify(frustum.planes[static_cast<std::size_t>(i)], box);
      if (c == Containment::outside) return true;
      if (c == Containment::inside) planes &= ~(1u << i);
    }
    return false;
  }

  /// Queues a node or an object unless it is outside or hidden by what is nearer already.
  void queue(std::uint32_t index, bool object, const Aabb& box, std::uint32_t planes, Counters& counters) {
    ++counters.boxes_tested;
    if (outside(frustum_, box, planes)) return;
    const HorizonBox seen = usable_ ? horizon_.project(box) : HorizonBox{};
    const double slack = 4e-7 * (std::abs(seen.nearest) + reach_);
    const Entry entry{static_cast<float>(seen.nearest - slack), index, usable_ ? horizon_.query(seen) : HorizonQuery{},
                      static_cast<std::uint16_t>(planes), object};
    // What is hidden now stays hidden: walls are only added.
    if (hidden(entry, counters)) return;
    open_.push_back(entry);
    std::push_heap(open_.begin(), open_.end(), farther);
  }

  bool hidden(const Entry& entry, Counters& counters) {
    // The horizon holds walls up to `added_`; a box that starts before may be in front of them.
    if (entry.asks.first > entry.asks.last || static_cast<double>(entry.nearest) < added_) return false;
    ++counters.queries;
    return horizon_.hides(entry.asks, counters.cells_tested);
  }

  void take_node(const Entry& entry, const VisibleSet& candidates, Counters& counters) {
    const BvhNode& node = bvh_.nodes[entry.index];
    ++counters.nodes_visited;
    if (hidden(entry, counters)) return;
    if (!node.leaf()) {
      queue(node.first, false, bvh_.nodes[node.first].bounds, entry.planes, counters);
      queue(node.first + 1, false, bvh_.nodes[node.first + 1].bounds, entry.planes, counters);
      return;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const ObjectId id = bvh_.items[i];
      const Aabb& box = scene_.objects()[id].bounds;
      if (!box.empty() && (all_ || candidates.contains(id))) queue(id, true, box, entry.planes, counters);
    }
  }

  void take_object(const Entry& entry, VisibleSet& visible, Counters& counters) {
    const auto id = static_cast<ObjectId>(entry.index);
    if (hidden(entry, counters)) return;
    visible.insert(id);
    if (!usable_ || !(boxes_ ? scene_.objects()[id].opaque : fences_->of(id) != nullptr)) return;
    const HorizonBox box = horizon_.project(scene_.objects()[id].bounds);
    if (box.askable && (box.u1 - box.u0) / (horizon_.border(1) - horizon_.border(0)) < 3.0) return;  // too narrow
    pending_.push_back({static_cast<float>(box.farthest + 4e-7 * (std::abs(box.farthest) + reach_)), id});
    std::push_heap(pending_.begin(), pending_.end(), later);
  }

  void add_walls_before(float nearest, Counters& counters) {
    while (!pending_.empty() && pending_.front().farthest <= nearest) {
      std::pop_heap(pending_.begin(), pending_.end(), later);
      const Pending wall = pending_.back();
      pending_.pop_back();
      added_ = std::max(added_, static_cast<double>(wall.farthest));
      ++counters.occluders;
      if (boxes_) {
        add_box(scene_.objects()[wall.id].bounds);
        continue;
      }
      const WallFences& set = *fences_->of(wall.id);
      const glm::dvec3 offset(scene_.objects()[wall.id].transform[3]);
      for (const WallFence& fence : set.fences) horizon_.add(fence, offset, set.slack + 1e-6 * reach_);
    }
  }

  void add_box(const Aabb& box) {
    const glm::dvec3 lo(box.lo), hi(box.hi);
    WallFence fence;
    fence.plan = {{lo.x, lo.z}, {hi.x, lo.z}, {hi.x, hi.z}, {lo.x, hi.z}, {lo.x, lo.z}};
    fence.y0 = lo.y;
    fence.y1 = hi.y;
    horizon_.add(fence, glm::dvec3(0.0), 0.0);
  }

  const Scene& scene_;
  const Bvh& bvh_;
  int columns_;
  bool boxes_;
  double reach_;
  std::unique_ptr<SceneFences> fences_;
  Horizon horizon_;
  Frustum frustum_;
  bool usable_ = false, all_ = false;
  double added_ = 0;  // the farthest wall that the horizon holds, plan distance
  std::vector<Entry> open_;
  std::vector<Pending> pending_;
};

}  // namespace

std::unique_ptr<Culler> make_occlusion_horizon(const IndexedScene& scene, ParameterReader& parameters) {
  int columns = 240;
  std::string occluders = "walls";
  parameters.read("columns", columns, 16, 16384);
  parameters.read("occluders", occluders);
  parameters.finish();
  if (occluders != "walls" && occluders != "boxes")
    throw InputError("", "occlusion_horizon: occluders", "must be walls or boxes, not '" + occluders + "'");
  return std::make_unique<OcclusionHorizon>(scene, columns, occluders == "boxes");
}

}  // namespace sightline
