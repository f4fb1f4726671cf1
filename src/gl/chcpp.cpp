#include "gl/chcpp.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

#include "gl/node_queue.hpp"
#include "gl/queries.hpp"
#include "sightline/scene/generate/random.hpp"

namespace sightline::gl {
namespace {

class Chcpp final : public Method {
 public:
  Chcpp(SceneDrawing& drawing, const ChcppConfig& config)
      : Method(drawing),
        config_(config),
        queries_(drawing, static_cast<std::uint32_t>(config.threshold)),
        random_(static_cast<std::uint64_t>(config.seed)) {
    reset();
  }

  [[nodiscard]] bool approximate() const override { return queries_.approximate(); }

  void reset() override {
    for (const Pending& pending : pending_) (void)queries_.seen(pending.name);
    pending_.clear();
    asked_.clear();
    waiting_ = 0;
    const Bvh& bvh = drawing_.bvh();
    state_.assign(bvh.nodes.size(), {});
    for (std::uint32_t n = 0; n < bvh.nodes.size(); ++n)
      if (!bvh.nodes[n].leaf())
        for (std::uint32_t c = 0; c < 2; ++c) state_[bvh.nodes[n].first + c].parent = n;
    for (std::size_t n = bvh.nodes.size(); n-- > 0;) {
      const BvhNode& node = bvh.nodes[n];
      for (std::uint32_t i = 0; i < node.count; ++i)
        state_[n].triangles += drawing_.triangles_of(bvh.items[node.first + i]);
      if (!node.leaf()) state_[n].triangles = state_[node.first].triangles + state_[node.first + 1].triangles;
    }
    tight_.build(bvh, config_.tight);
    revision_ = drawing_.revision();
    frame_ = 1;
    persistence_.assign(64, {});
    random_ = Random(static_cast<std::uint64_t>(config_.seed));
  }

 private:
  struct NodeState {
    std::uint64_t triangles = 0;  // below the node
    std::uint32_t parent = 0;
    std::uint32_t last_visited = 0;   // frame
    std::uint32_t drawn = 0;          // frame
    std::uint32_t hidden_frames = 0;  // how often in a row it was found hidden; kept while it is outside the frustum
    std::uint32_t next_query = 0;     // frame until which it is taken for seen: a leaf is drawn, an inner node opened
    std::uint32_t confirmed = 0;      // how often in a row a query has found it seen
    bool visible = false;
    bool asked = false;  // a query about it as a visible leaf is under way
  };

  /// What happened to nodes that had been hidden for so many frames.
  struct Persistence {
    double kept = 0.0, all = 0.0;
  };

  /// A query under way: for which nodes (a range of asked_), and in which role.
  struct Pending {
    unsigned name;
    std::uint32_t first, count;
    bool of_visible;
  };

  void render() override {
    ++frame_;
    if (revision_ != drawing_.revision()) {
      tight_.build(drawing_.bvh(), config_.tight);
      revision_ = drawing_.revision();
    }
    begin_answers();
    push(0);
    for (;;) {
      if (!config_.deterministic) take_ready();
      if (!distance_.empty()) {
        const std::uint32_t n = distance_.top().node;
        distance_.pop();
        visit(n);
      } else if (!hidden_.empty() || !singles_.empty()) {
        ask_hidden();
      } else if (!pending_.empty() && waiting_ > 0) {
        wait();
      } else {
        break;
      }
    }
    flush();
    ask_visible();
  }

  // ---- traversal

  void push(std::uint32_t n) {
    const Aabb& box = drawing_.bvh().nodes[n].bounds;
    if (classify(drawing_.frustum(), box) != Containment::outside) distance_.push({drawing_.distance2(box), n});
  }

  void visit(std::uint32_t n) {
    NodeState& state = state_[n];
    const BvhNode& node = drawing_.bvh().nodes[n];
    ++drawing_.work().nodes;
    const bool was_visible = state.visible && state.last_visited == frame_ - 1;
    state.last_visited = frame_;
    if (drawing_.near_or_inside(node.bounds)) {
      came_into_sight(n);
      return traverse(n, 1);
    }
    if (!was_visible) {
      state.visible = false;
      if (!node.leaf() && state.next_query > frame_) return traverse(n, 1);  // its box was seen, whatever is in it
      hidden_.push_back(n);
      if (config_.batch > 0 && hidden_.size() >= static_cast<std::size_t>(config_.batch)) ask_hidden();
      return;
    }
    if (node.leaf()) {
      if (state.next_query <= frame_ && !state.asked) visible_.push_back(n);
      pull_up(n);  // until its own query says otherwise
    }
    traverse(n, 1);
  }

  /// A leaf is put into the render queue; of an inner node the descendants `levels` down are visited.
  void traverse(std::uint32_t n, int levels) {
    const BvhNode& node = drawing_.bvh().nodes[n];
    if (node.leaf()) {
      if (state_[n].drawn == frame_) return;
      state_[n].drawn = frame_;
      for (std::uint32_t i = 0; i < node.count; ++i)
        if (const ObjectId id = drawing_.bvh().items[node.first + i]; is_candidate(id)) render_queue_.push_back(id);
      return;
    }
    state_[n].visible = false;  // a visible leaf will say so
    for (std::uint32_t c = node.first; c < node.first + 2; ++c)
      if (levels > 1 && !drawing_.bvh().nodes[c].leaf()) {
        state_[c].last_visited = frame_;
        if (classify(drawing_.frustum(), drawing_.bvh().nodes[c].bounds) != Containment::outside)
          traverse(c, levels - 1);
      } else {
        push(c);
      }
  }

  void flush() {
    draw(render_queue_);
    render_queue_.clear();
  }

  void pull_up(std::uint32_t n) {
    state_[n].visible = true;
    n = state_[n].parent;
    while (!state_[n].visible) {
      state_[n].visible = true;
      n = state_[n].parent;  // the root is its own parent
    }
  }

  // ---- questions

  /// Probability that a node stays hidden: the paper's curve, or what this walk has shown so far, starting from it.
  [[nodiscard]] double keep(std::uint32_t n) const {
    const double paper = keep_probability(state_[n].hidden_frames);
    if (!config_.measured) return paper;
    const Persistence& seen = persistence_[std::min<std::size_t>(state_[n].hidden_frames, persistence_.size() - 1)];
    constexpr double trust = 32.0;  // observations that weigh as much as the curve
    return std::min((trust * paper + seen.kept) / (trust + seen.all), 0.9999);
  }

  void learn(std::uint32_t n, bool hidden) {
    Persistence& seen = persistence_[std::min<std::size_t>(state_[n].hidden_frames, persistence_.size() - 1)];
    seen.all += 1.0;
    seen.kept += hidden ? 1.0 : 0.0;
    if (seen.all < 4096.0) return;  // what was long ago counts less
    seen.all *= 0.5;
    seen.kept *= 0.5;
  }

  /// Queries for the nodes that wait in the i-queue, and for those of a multiquery that failed, one by one.
  void ask_hidden() {
    flush();  // what was visible hides what is asked about
    begin_questions();
    for (const std::uint32_t n : singles_) add_question({&n, 1}, false);
    singles_.clear();
    std::vector<std::pair<double, std::uint32_t>> sorted;
    for (const std::uint32_t n : hidden_) sorted.emplace_back(keep(n), n);
    std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    candidates_.clear();
    for (std::size_t i = 0; i < sorted.size(); ++i) {
      hidden_[i] = sorted[i].second;
      candidates_.push_back({sorted[i].first, static_cast<double>(state_[hidden_[i]].triangles)});
    }
    for (std::size_t i = 0; i < hidden_.size();) {
      const std::size_t size =
          config_.multiqueries ? multiquery_size(std::span(candidates_).subspan(i), config_.multiquery) : 1;
      add_question(std::span(hidden_).subspan(i, size), false);
      i += size;
    }
    hidden_.clear();
    end_questions();
  }

  /// At the end of the frame, when the depth is complete: the answers are needed in the next one.
  void ask_visible() {
    begin_questions();
    for (const std::uint32_t n : visible_) {
      state_[n].asked = true;
      add_question({&n, 1}, true);
    }
    visible_.clear();
    end_questions();
  }

  void begin_questions() {
    boxes_.clear();
    asks_.clear();
    new_pending_.clear();
  }

  void add_question(std::span<const std::uint32_t> nodes, bool of_visible) {
    const std::size_t before = boxes_.size();
    for (const std::uint32_t n : nodes) {
      const std::span<const Aabb> boxes = tight_.boxes(n);
      boxes_.insert(boxes_.end(), boxes.begin(), boxes.end());
    }
    asks_.push_back({static_cast<std::uint32_t>(boxes_.size() - before), static_cast<std::uint32_t>(nodes.size())});
    new_pending_.push_back(
        {0, static_cast<std::uint32_t>(asked_.size()), static_cast<std::uint32_t>(nodes.size()), of_visible});
    asked_.insert(asked_.end(), nodes.begin(), nodes.end());
  }

  void end_questions() {
    names_.clear();
    queries_.issue(boxes_, asks_, names_);
    for (std::size_t i = 0; i < names_.size(); ++i) {
      new_pending_[i].name = names_[i];
      pending_.push_back(new_pending_[i]);
      waiting_ += new_pending_[i].of_visible ? 0 : 1;
    }
  }

  // ---- answers

  /// The answers about visible leaves that the frame before asked for.
  void begin_answers() {
    std::deque<Pending> late;
    const Timeline::Guard guard(drawing_.timeline(), 'R', static_cast<std::uint32_t>(pending_.size()));
    while (!pending_.empty()) {
      const Pending pending = pending_.front();
      pending_.pop_front();
      if (config_.deterministic || queries_.available(pending.name))
        handle(pending, queries_.seen(pending.name));
      else
        late.push_back(pending);
    }
    // Their nodes go to the front of asked_, so that it does not grow for ever.
    std::vector<std::uint32_t> kept;
    for (Pending& pending : late) {
      const auto first = static_cast<std::uint32_t>(kept.size());
      kept.insert(kept.end(), asked_.begin() + pending.first, asked_.begin() + pending.first + pending.count);
      pending.first = first;
    }
    asked_.swap(kept);
    pending_.swap(late);
  }

  void take_ready() {
    while (!pending_.empty() && queries_.available(pending_.front().name)) take(queries_.seen(pending_.front().name));
  }

  /// Nothing is left to do without an answer: wait for the last of them, then all are there.
  void wait() {
    flush();
    if (!config_.deterministic) return take(queries_.seen_now(pending_.front().name));
    std::vector<bool> seen(pending_.size());
    seen.back() = queries_.seen_now(pending_.back().name);
    const Timeline::Guard guard(drawing_.timeline(), 'R', static_cast<std::uint32_t>(pending_.size()));
    for (std::size_t i = 0; i + 1 < seen.size(); ++i) seen[i] = queries_.seen(pending_[i].name);
    for (std::size_t i = 0; i < seen.size(); ++i) take(seen[i]);
  }

  void take(bool seen) {
    const Pending pending = pending_.front();
    pending_.pop_front();
    waiting_ -= pending.of_visible ? 0 : 1;
    handle(pending, seen);
  }

  void handle(const Pending& pending, bool seen) {
    if (log_ != nullptr) log(pending, seen);
    const auto nodes = [&](std::uint32_t i) { return asked_[pending.first + i]; };
    if (pending.of_visible) {
      state_[nodes(0)].asked = false;
      return seen ? stays_visible(nodes(0)) : goes_out_of_sight(nodes(0), 0);
    }
    for (std::uint32_t i = 0; i < pending.count; ++i) {
      const std::uint32_t n = nodes(i);
      if (!seen || pending.count == 1) learn(n, !seen);
      if (!seen) {
        goes_out_of_sight(n, state_[n].hidden_frames + 1);
      } else if (pending.count > 1) {
        singles_.push_back(n);
      } else {
        came_into_sight(n);
        traverse(n, config_.open);
      }
    }
  }

  void goes_out_of_sight(std::uint32_t n, std::uint32_t hidden_frames) {
    NodeState& state = state_[n];
    state.visible = false;
    state.hidden_frames = hidden_frames;
    state.confirmed = 0;
    state.next_query = 0;
  }

  void stays_visible(std::uint32_t n) {
    ++state_[n].confirmed;
    state_[n].next_query = frame_ + interval(n);
  }

  void came_into_sight(std::uint32_t n) {
    NodeState& state = state_[n];
    const std::uint32_t frames = interval(n);
    const bool at_random = config_.random && frames > 1 && state.confirmed == 0;
    state.next_query = frame_ + (at_random ? 1 + random_.below(frames) : frames);
    state.hidden_frames = 0;
    if (drawing_.bvh().nodes[n].leaf())
      state.confirmed = 0;
    else
      ++state.confirmed;
    pull_up(n);
  }

  /// Frames for which a seen leaf is drawn, and an inner node opened, without a question.
  [[nodiscard]] std::uint32_t interval(std::uint32_t n) const {
    if (config_.assumed == 0) return 0;
    double frames = config_.assumed;
    if (config_.adapt && !drawing_.bvh().nodes[n].leaf()) frames *= std::min(1.0 + state_[n].confirmed, 4.0);
    if (config_.adapt && drawing_.bvh().nodes[n].leaf()) {
      const double worth = config_.query_cost / std::max(1.0, static_cast<double>(state_[n].triangles));
      frames *= std::clamp(std::sqrt(worth), 1.0, 16.0);
      frames *= std::min(1.0 + state_[n].confirmed, 4.0);
    }
    return static_cast<std::uint32_t>(frames);
  }

  void log(const Pending& pending, bool seen) {
    *log_ += std::to_string(frame_) + (pending.of_visible ? " leaf" : " nodes");
    for (std::uint32_t i = 0; i < pending.count; ++i) *log_ += " " + std::to_string(asked_[pending.first + i]);
    *log_ += seen ? " seen\n" : " hidden\n";
  }

  ChcppConfig config_;
  OcclusionQueries queries_;
  Random random_;
  TightBounds tight_;
  std::uint64_t revision_ = 0;
  std::vector<NodeState> state_;
  std::vector<Persistence> persistence_;  // by hidden_frames
  std::uint32_t frame_ = 1;
  NodeQueue distance_;
  std::vector<std::uint32_t> hidden_, singles_, visible_, asked_;  // i-queue; of failed multiqueries; v-queue
  std::vector<ObjectId> render_queue_;
  std::deque<Pending> pending_;  // the query queue
  std::size_t waiting_ = 0;      // those of pending_ whose answers this frame needs
  std::vector<Aabb> boxes_;
  std::vector<OcclusionQueries::Ask> asks_;
  std::vector<MultiqueryCandidate> candidates_;
  std::vector<Pending> new_pending_;
  std::vector<unsigned> names_;
};

}  // namespace

std::unique_ptr<Method> make_chcpp(SceneDrawing& drawing, const ChcppConfig& config) {
  return std::make_unique<Chcpp>(drawing, config);
}

}  // namespace sightline::gl
