#include "sightline/cull/occlusion_horizon.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>

#include "sightline/parallel/parallel.hpp"
#include "sightline/raster/horizon.hpp"
#include "sightline/scene/input_error.hpp"
#include "sightline/scene/occludee_bounds.hpp"

namespace sightline {
namespace {

glm::mat3 linear_part(const Object& object) { return glm::mat3(object.transform); }

/// The fences of every opaque object: found once for each mesh and linear map, then moved to where the object stands.
class SceneFences {
 public:
  explicit SceneFences(const Scene& scene) : scene_(scene), set_of_(scene.objects().size(), none) {
    std::vector<ObjectId> order;
    for (ObjectId id = 0; id < scene.objects().size(); ++id)
      if (scene.objects()[id].opaque && !scene.objects()[id].bounds.empty()) order.push_back(id);
    const auto key = [&](ObjectId id) {
      const glm::mat3 linear = linear_part(scene.objects()[id]);
      std::array<float, 9> k{};
      for (int i = 0; i < 9; ++i) k[static_cast<std::size_t>(i)] = linear[i / 3][i % 3];
      return std::pair(scene.objects()[id].mesh, k);
    };
    std::stable_sort(order.begin(), order.end(), [&](ObjectId a, ObjectId b) { return key(a) < key(b); });
    std::vector<ObjectId> first;
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (i == 0 || key(order[i]) != key(order[i - 1])) first.push_back(order[i]);
      set_of_[order[i]] = static_cast<std::uint32_t>(first.size() - 1);
    }
    sets_.resize(first.size());
    shared_ = sets_.size();
    find(first);
  }

  /// An object that was turned gets a set of its own, once and for all: it may turn again.
  void follow() {
    std::vector<ObjectId> turned;
    for (ObjectId id = 0; id < set_of_.size(); ++id) {
      if (set_of_[id] == none || sets_[set_of_[id]].linear == linear_part(scene_.objects()[id])) continue;
      turned.push_back(id);
      if (set_of_[id] >= shared_) continue;
      set_of_[id] = static_cast<std::uint32_t>(sets_.size());
      sets_.emplace_back();
    }
    find(turned);
  }

  /// nullptr if the object has no wall.
  [[nodiscard]] const WallFences* of(ObjectId id) const {
    if (set_of_[id] == none || sets_[set_of_[id]].walls.fences.empty()) return nullptr;
    return &sets_[set_of_[id]].walls;
  }

 private:
  struct Set {
    glm::mat3 linear{0.0f};  // from the mesh to the world
    WallFences walls;
  };

  /// The sets of these objects, each another one.
  void find(const std::vector<ObjectId>& ids) {
    parallel_blocks(ids.size(), 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Object& object = scene_.objects()[ids[i]];
        const glm::mat3 linear = linear_part(object);
        sets_[set_of_[ids[i]]] = {linear, find_wall_fences(scene_.meshes()[object.mesh], glm::dmat3(linear))};
      }
    });
  }

  static constexpr std::uint32_t none = 0xFFFFFFFFu;
  const Scene& scene_;
  std::vector<std::uint32_t> set_of_;
  std::vector<Set> sets_;
  std::size_t shared_ = 0;  // sets that several objects may have; those after them belong to one each
};

/// Numbers by distance, the least first, equal ones by number. Distance and number are one integer, so that an
/// entry moves and compares as fast as can be.
class DistanceQueue {
 public:
  [[nodiscard]] bool empty() const { return heap_.empty(); }
  void clear() { heap_.clear(); }
  void push(float distance, std::uint32_t number) {
    const auto bits = std::bit_cast<std::uint32_t>(distance);
    heap_.push_back(std::uint64_t{bits ^ ((bits & sign) != 0 ? ~0u : sign)} << 32 | number);
    std::push_heap(heap_.begin(), heap_.end(), std::greater());
  }
  [[nodiscard]] float least() const {
    const auto bits = static_cast<std::uint32_t>(heap_.front() >> 32);
    return std::bit_cast<float>(bits ^ ((bits & sign) != 0 ? sign : ~0u));
  }
  /// The number with the least distance.
  std::uint32_t pop() {
    std::pop_heap(heap_.begin(), heap_.end(), std::greater());
    const auto number = static_cast<std::uint32_t>(heap_.back());
    heap_.pop_back();
    return number;
  }

 private:
  static constexpr std::uint32_t sign = 1u << 31;
  std::vector<std::uint64_t> heap_;  // floats as integers of the same order, then the number
};

std::vector<Aabb> node_bounds(const Bvh& bvh) {
  std::vector<Aabb> boxes;
  boxes.reserve(bvh.nodes.size());
  for (const BvhNode& node : bvh.nodes) boxes.push_back(node.bounds);
  return boxes;
}

/// Subtrees with at most so many objects are asked object by object, a vector of them at once.
constexpr std::uint32_t few = 32;

class OcclusionHorizon final : public Culler {
 public:
  OcclusionHorizon(const IndexedScene& scene, int columns, bool boxes, double tight)
      : indexed_(scene),
        scene_(scene.scene),
        bvh_(scene.bvh),
        columns_(columns),
        boxes_(boxes),
        reach_(reach(scene.scene.bounds())),
        ranges_(item_ranges(scene.bvh)),
        node_boxes_(node_bounds(scene.bvh)),
        item_boxes_(bounds_in_tree_order(scene)) {
    if (!boxes) fences_ = std::make_unique<SceneFences>(scene.scene);
    if (tight > 1.0) tight_ = OccludeeBounds(scene_, {.sigma = tight});
    part_boxes_ = BoxArrays(tight_.boxes());
  }

  void cull(const View& view, const VisibleSet& candidates, VisibleSet& visible, Counters& counters) override {
    visible.reset(candidates.universe());
    if (bvh_.nodes.empty()) return;
    frustum_ = view_frustum(view, reach_);
    all_ = candidates.is_all();
    if (!horizon_.begin(view, columns_)) {
      counters.boxes_tested += item_boxes_.count;
      found_.resize(item_boxes_.count + 64);
      const std::size_t found = boxes_in_frustum(item_boxes_, frustum_, found_.data());
      for (const std::uint32_t item : std::span(found_).first(found))
        if (all_ || candidates.contains(bvh_.items[item])) visible.insert(bvh_.items[item]);
      return;
    }
    walls_to_ = -std::numeric_limits<float>::infinity();
    boxes_over_.clear();
    open_.clear();
    walls_.clear();
    ask(node_boxes_, {0, 1}, node_mark, counters);
    while (!open_.empty()) {
      const HorizonBox box = boxes_over_[open_.pop()];
      add_walls_before(box.nearest, counters);
      if (box.nearest >= walls_to_ && hidden_by_horizon(horizon_.plan(), box, counters)) continue;
      if ((box.index & node_mark) != 0)
        take_node(box.index & ~node_mark, counters);
      else if ((all_ || candidates.contains(bvh_.items[box.index])) && parts_may_be_seen(box, counters))
        take_object(box, visible);
    }
  }

  bool follow_scene() override {
    node_boxes_ = BoxArrays(node_bounds(bvh_));
    item_boxes_ = BoxArrays(bounds_in_tree_order(indexed_));
    reach_ = reach(scene_.bounds());
    if (fences_) fences_->follow();
    if (!tight_.empty()) {
      tight_.follow(scene_);
      part_boxes_ = BoxArrays(tight_.boxes());
    }
    return true;
  }

  [[nodiscard]] Promise promise(Promise of_row) const override { return boxes_ ? Promise::approximate : of_row; }

 private:
  static constexpr std::uint32_t node_mark = 1u << 31;  // in the index of a queued box: a node; else a place of items

  /// Queues those that are neither outside nor hidden by what is nearer already: walls are only added.
  void ask(const BoxArrays& boxes, const ItemRange& range, std::uint32_t mark, Counters& counters) {
    counters.boxes_tested += range.end - range.begin;
    const std::size_t known = boxes_over_.size();
    boxes_over_.resize(known + range.end - range.begin);
    boxes_over_.resize(known + boxes_over_horizon(horizon_.plan(), boxes, range.begin, range.end, frustum_, walls_to_,
                                                  boxes_over_.data() + known, counters));
    for (std::size_t i = known; i < boxes_over_.size(); ++i) {
      boxes_over_[i].index |= mark;
      open_.push(boxes_over_[i].nearest, static_cast<std::uint32_t>(i));
    }
  }

  void take_node(std::uint32_t index, Counters& counters) {
    ++counters.nodes_visited;
    const BvhNode& node = bvh_.nodes[index];
    const ItemRange& items = ranges_[index];
    if (node.leaf() || items.end - items.begin <= few)
      ask(item_boxes_, items, 0, counters);
    else
      ask(node_boxes_, {node.first, node.first + 2}, node_mark, counters);
  }

  /// The tight bounds of an object whose box may be seen; true without.
  bool parts_may_be_seen(const HorizonBox& box, Counters& counters) {
    const ObjectId id = bvh_.items[box.index];
    if (tight_.empty() || tight_.boxes(id).size() <= 1) return true;
    const std::uint32_t begin = tight_.first(id), end = tight_.first(id + 1);
    parts_over_.resize(end - begin);
    return boxes_over_horizon(horizon_.plan(), part_boxes_, begin, end, frustum_, walls_to_, parts_over_.data(),
                              counters) > 0;
  }

  void take_object(const HorizonBox& box, VisibleSet& visible) {
    const ObjectId id = bvh_.items[box.index];
    visible.insert(id);
    if (!(boxes_ ? scene_.objects()[id].opaque : fences_->of(id) != nullptr)) return;
    // What is narrower than a fortieth of the view costs as much as other walls, and hides little.
    if (box.first <= box.last && box.last - box.first < columns_ / 40) return;
    walls_.push(box.farthest + static_cast<float>(8e-7 * reach_), id);
  }

  void add_walls_before(float nearest, Counters& counters) {
    while (!walls_.empty() && walls_.least() <= nearest) {
      walls_to_ = std::max(walls_to_, walls_.least());
      const ObjectId id = walls_.pop();
      ++counters.occluders;
      if (boxes_) {
        add_box(scene_.objects()[id].bounds);
        continue;
      }
      const WallFences& set = *fences_->of(id);
      const glm::dvec3 offset(scene_.objects()[id].transform[3]);
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

  const IndexedScene& indexed_;
  const Scene& scene_;
  const Bvh& bvh_;
  int columns_;
  bool boxes_;
  double reach_;
  std::vector<ItemRange> ranges_;                  // items below each node
  BoxArrays node_boxes_, item_boxes_;              // of bvh_.nodes and bvh_.items, in their order
  OccludeeBounds tight_;                           // empty without
  BoxArrays part_boxes_{std::span<const Aabb>()};  // of tight_.boxes(), in their order
  std::unique_ptr<SceneFences> fences_;
  Horizon horizon_;
  Frustum frustum_;
  bool all_ = false;
  float walls_to_ = 0;  // where the farthest wall of the horizon ends, plan distance
  std::vector<std::uint32_t> found_;
  std::vector<HorizonBox> parts_over_;  // tight boxes of an object that were not hidden
  std::vector<HorizonBox> boxes_over_;  // all that were found in the frustum and not hidden
  DistanceQueue open_;                  // those of boxes_over_ that are still to be taken, by where they begin
  DistanceQueue walls_;                 // objects whose walls are still to be added, by where they end
};

}  // namespace

std::unique_ptr<Culler> make_occlusion_horizon(const IndexedScene& scene, ParameterReader& parameters) {
  int columns = 120;
  double tight = 1.0;
  std::string occluders = "walls";
  parameters.read("columns", columns, 16, 16384);
  parameters.read("occluders", occluders);
  parameters.read("tight", tight, 1.0, 100.0);
  parameters.finish();
  if (occluders != "walls" && occluders != "boxes")
    throw InputError("", "occlusion_horizon: occluders", "must be walls or boxes, not '" + occluders + "'");
  return std::make_unique<OcclusionHorizon>(scene, columns, occluders == "boxes", tight);
}

}  // namespace sightline
