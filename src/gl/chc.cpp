#include "gl/chc.hpp"

#include <deque>

#include "gl/node_queue.hpp"
#include "gl/queries.hpp"

namespace sightline::gl {
namespace {

struct Config {
  bool hierarchy = true;
  bool deterministic = true;
  int threshold = 1;
};

class Chc final : public Method {
 public:
  Chc(SceneDrawing& drawing, const Config& config)
      : Method(drawing), config_(config), queries_(drawing, static_cast<std::uint32_t>(config.threshold)) {
    reset();
  }

  [[nodiscard]] bool approximate() const override { return queries_.approximate(); }

  void reset() override {
    const Bvh& bvh = drawing_.bvh();
    state_.assign(bvh.nodes.size(), {});
    for (std::uint32_t n = 0; n < bvh.nodes.size(); ++n)
      if (!bvh.nodes[n].leaf())
        for (std::uint32_t c = 0; c < 2; ++c) state_[bvh.nodes[n].first + c].parent = n;
    frame_ = 1;
  }

 private:
  struct NodeState {
    std::uint32_t parent = 0, last_visited = 0, drawn = 0;
    bool visible = false;
  };
  struct Pending {
    unsigned name;
    std::uint32_t node;
  };

  void render() override {
    ++frame_;
    start();
    while (!distance_.empty() || !pending_.empty()) {
      while (!pending_.empty() && (distance_.empty() || (!config_.deterministic && queries_.available(front()))))
        handle_front();
      if (distance_.empty()) continue;
      const std::uint32_t n = distance_.top().node;
      distance_.pop();
      visit(n);
    }
  }

  unsigned front() const { return pending_.front().name; }

  /// Without the hierarchy the list of the slides: every object, front to back.
  void start() {
    if (config_.hierarchy) return push(0);
    for (std::uint32_t n = 0; n < state_.size(); ++n)
      if (drawing_.bvh().nodes[n].leaf()) push(n);
  }

  void push(std::uint32_t n) {
    const Aabb& box = drawing_.bvh().nodes[n].bounds;
    if (classify(drawing_.frustum(), box) != Containment::outside) distance_.push({drawing_.distance2(box), n});
  }

  void visit(std::uint32_t n) {
    const BvhNode& node = drawing_.bvh().nodes[n];
    NodeState& state = state_[n];
    ++drawing_.work().nodes;
    const bool was_visible = state.visible && state.last_visited == frame_ - 1;
    state.last_visited = frame_;
    state.visible = false;
    if (drawing_.near_or_inside(node.bounds)) {
      pull_up(n);
      return traverse(n);
    }
    if (!(was_visible && !node.leaf())) {
      const OcclusionQueries::Ask ask{1, 1};
      names_.clear();
      queries_.issue({&node.bounds, 1}, {&ask, 1}, names_);
      pending_.push_back({names_[0], n});
    }
    if (was_visible) traverse(n);
  }

  void traverse(std::uint32_t n) {
    const BvhNode& node = drawing_.bvh().nodes[n];
    if (!node.leaf()) {
      push(node.first);
      push(node.first + 1);
      return;
    }
    if (state_[n].drawn == frame_) return;
    state_[n].drawn = frame_;
    for (std::uint32_t i = 0; i < node.count; ++i) {
      const ObjectId id = drawing_.bvh().items[node.first + i];
      if (is_candidate(id)) draw({&id, 1});
    }
  }

  void handle_front() {
    const Pending pending = pending_.front();
    pending_.pop_front();
    const bool seen = distance_.empty() ? queries_.seen_now(pending.name) : queries_.seen(pending.name);
    if (log_ != nullptr)
      *log_ += std::to_string(frame_) + " node " + std::to_string(pending.node) + (seen ? " seen\n" : " hidden\n");
    if (!seen) return;
    pull_up(pending.node);
    traverse(pending.node);
  }

  void pull_up(std::uint32_t n) {
    while (!state_[n].visible) {
      state_[n].visible = true;
      n = state_[n].parent;  // the root is its own parent
    }
  }

  Config config_;
  OcclusionQueries queries_;
  std::vector<NodeState> state_;
  std::uint32_t frame_ = 1;
  NodeQueue distance_;
  std::deque<Pending> pending_;
  std::vector<unsigned> names_;
};

}  // namespace

std::unique_ptr<Method> make_chc(SceneDrawing& drawing, ParameterReader& parameters) {
  Config config;
  config.deterministic = drawing.context().software();
  parameters.read("hierarchy", config.hierarchy);
  parameters.read("deterministic", config.deterministic);
  parameters.read("threshold", config.threshold, 1, 1 << 24);
  parameters.finish();
  return std::make_unique<Chc>(drawing, config);
}

}  // namespace sightline::gl
