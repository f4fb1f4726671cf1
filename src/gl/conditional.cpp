#include "gl/conditional.hpp"

#include <algorithm>
#include <string>

#include "gl/node_queue.hpp"
#include "gl/queries.hpp"
#include "sightline/scene/input_error.hpp"

namespace sightline::gl {
namespace {

struct Config {
  int group = 16;    // objects of a hidden subtree that share a query
  int assumed = 10;  // a visible object is asked about every so many frames
  bool wait = true;  // the device waits for its query; off: it draws if the answer is late
};

/// Objects seen before are drawn at once. Subtrees in which nothing was seen are asked about, and drawn on condition.
/// The processor reads the answers one frame later, when they are there, to know what to draw at once then.
class Conditional final : public Method {
 public:
  Conditional(SceneDrawing& drawing, const Config& config) : Method(drawing), config_(config), queries_(drawing, 1) {
    reset();
  }

  void reset() override {
    for (const Question& question : questions_) (void)queries_.seen(question.name);
    questions_.clear();
    visible_.assign(drawing_.scene().objects().size(), 0);
    subtree_visible_.assign(drawing_.bvh().nodes.size(), 0);
    frame_ = 0;
  }

  void drawn(std::vector<ObjectId>& ids) override {
    ids = drawn_;
    for (const Question& question : questions_) {
      if (question.of_visible) continue;
      GLuint seen = 0;
      glGetQueryObjectuiv(question.name, GL_QUERY_RESULT, &seen);
      if (seen != 0 || !config_.wait) ids.insert(ids.end(), question.objects.begin(), question.objects.end());
    }
  }

 private:
  struct Question {
    unsigned name;
    bool of_visible;
    std::vector<ObjectId> objects;
  };

  void render() override {
    ++frame_;
    read_answers();
    find_visible_subtrees();
    traverse();
    draw(now_);
    ask(false);
    draw_on_condition();
    ask(true);
  }

  void read_answers() {
    for (const Question& question : questions_) {
      const bool seen = queries_.seen(question.name);
      if (log_ != nullptr) {
        *log_ += std::to_string(frame_ - 1) + " objects";
        for (const ObjectId id : question.objects) *log_ += " " + std::to_string(id);
        *log_ += seen ? " seen\n" : " hidden\n";
      }
      for (const ObjectId id : question.objects) {
        if (seen && !question.of_visible) {
          ++drawing_.work().objects;
          drawing_.work().triangles += drawing_.triangles_of(id);
        }
        // Of a group that is seen each object is asked about by itself, soon but not all at once.
        if (seen && visible_[id] == 0) visible_[id] = frame_ + id % 4;
        if (!seen) visible_[id] = 0;
        if (seen && question.of_visible) visible_[id] = frame_ + static_cast<std::uint32_t>(config_.assumed);
      }
    }
    questions_.clear();
  }

  void find_visible_subtrees() {
    const Bvh& bvh = drawing_.bvh();
    for (std::size_t n = bvh.nodes.size(); n-- > 0;) {
      const BvhNode& node = bvh.nodes[n];
      bool any = false;
      for (std::uint32_t i = 0; i < node.count; ++i) any = any || visible_[bvh.items[node.first + i]] != 0;
      if (!node.leaf()) any = subtree_visible_[node.first] != 0 || subtree_visible_[node.first + 1] != 0;
      subtree_visible_[n] = any ? 1 : 0;
    }
  }

  void traverse() {
    const Bvh& bvh = drawing_.bvh();
    now_.clear();
    groups_.clear();
    visible_questions_.clear();
    NodeQueue queue;
    queue.push({0.0f, 0});
    while (!queue.empty()) {
      const std::uint32_t n = queue.top().node;
      const BvhNode& node = bvh.nodes[n];
      queue.pop();
      ++drawing_.work().nodes;
      if (classify(drawing_.frustum(), node.bounds) == Containment::outside) continue;
      const ItemRange range = items_below(bvh, n);
      const bool close = drawing_.near_or_inside(node.bounds);
      if (!close && subtree_visible_[n] == 0 && range.end - range.begin <= static_cast<std::uint32_t>(config_.group)) {
        groups_.push_back(n);
      } else if (!node.leaf()) {
        for (std::uint32_t c = node.first; c < node.first + 2; ++c)
          queue.push({drawing_.distance2(bvh.nodes[c].bounds), c});
      } else {
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
          const ObjectId id = bvh.items[i];
          if (!is_candidate(id)) continue;
          now_.push_back(id);
          if (visible_[id] <= frame_ && !close) visible_questions_.push_back(id);
        }
      }
    }
  }

  void ask(bool of_visible) {
    std::vector<Aabb> boxes;
    std::vector<OcclusionQueries::Ask> asks;
    const std::size_t first = questions_.size();
    if (of_visible) {
      for (const ObjectId id : visible_questions_) {
        boxes.push_back(drawing_.bounds()[id]);
        asks.push_back({1, 1});
        questions_.push_back({0, true, {id}});
      }
    } else {
      for (const std::uint32_t n : groups_) {
        Question question{0, false, {}};
        const ItemRange range = items_below(drawing_.bvh(), n);
        for (std::uint32_t i = range.begin; i < range.end; ++i)
          if (const ObjectId id = drawing_.bvh().items[i]; is_candidate(id)) question.objects.push_back(id);
        if (question.objects.empty()) continue;
        boxes.push_back(drawing_.bvh().nodes[n].bounds);
        asks.push_back({1, 1});
        questions_.push_back(std::move(question));
      }
    }
    std::vector<unsigned> names;
    queries_.issue(boxes, asks, names);
    for (std::size_t i = 0; i < names.size(); ++i) questions_[first + i].name = names[i];
  }

  /// Counted when the answers are read: only then it is known what was drawn.
  void draw_on_condition() {
    Work unused;
    Work& counted = drawing_.work();
    drawing_.set_work(&unused);
    for (const Question& question : questions_) {
      glBeginConditionalRender(question.name, config_.wait ? GL_QUERY_WAIT : GL_QUERY_NO_WAIT);
      drawing_.draw(question.objects);
      glEndConditionalRender();
    }
    drawing_.set_work(&counted);
    drawing_.work().draw_calls += unused.draw_calls;
  }

  Config config_;
  OcclusionQueries queries_;
  std::vector<std::uint32_t> visible_;         // 0: hidden; else the frame in which to ask again
  std::vector<std::uint8_t> subtree_visible_;  // by node
  std::vector<Question> questions_;
  std::vector<ObjectId> now_, visible_questions_;
  std::vector<std::uint32_t> groups_;
  std::uint32_t frame_ = 0;
};

}  // namespace

std::unique_ptr<Method> make_conditional(SceneDrawing& drawing, ParameterReader& parameters) {
  Config config;
  parameters.read("group", config.group, 1, 1 << 20);
  parameters.read("assumed", config.assumed, 0, 1000);
  parameters.read("wait", config.wait);
  parameters.finish();
  return std::make_unique<Conditional>(drawing, config);
}

}  // namespace sightline::gl
