// The hierarchy over boxes: every box once, bounds that hold what is below them, whatever the boxes and the threads.
#include "sightline/index/bvh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "properties.hpp"
#include "sightline/index/bvh_builders.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/scene/generate/random.hpp"

namespace sightline {
namespace {

/// What is wrong with a hierarchy over these boxes, or an empty string.
std::string complaint(const Bvh& bvh, const std::vector<Aabb>& boxes, const BvhConfig& config) {
  if (boxes.empty()) return bvh.nodes.empty() && bvh.items.empty() ? "" : "not empty";
  if (bvh.nodes.empty()) return "no root";
  if (bvh.items.size() != boxes.size()) return "wrong number of items";
  std::vector<int> seen(boxes.size(), 0), reached(bvh.nodes.size(), 0), item_reached(boxes.size(), 0);
  for (const std::uint32_t item : bvh.items) {
    if (item >= boxes.size()) return "an item that is no box";
    if (++seen[item] > 1) return "an item twice";
  }
  reached[0] = 1;
  for (std::size_t i = 0; i < bvh.nodes.size(); ++i) {
    const BvhNode& node = bvh.nodes[i];
    if (reached[i] != 1) return "a node that has not one parent before it";
    if (node.leaf()) {
      if (node.count > static_cast<std::uint32_t>(config.max_leaf_size)) return "a leaf too large";
      if (node.first + node.count > bvh.items.size()) return "a leaf beyond the items";
      for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
        ++item_reached[k];
        const Aabb& box = boxes[bvh.items[k]];
        if (!box.empty() && !node.bounds.contains(box)) return "a box outside its leaf";
      }
      continue;
    }
    for (const std::size_t child : {std::size_t{node.first}, std::size_t{node.first} + 1}) {
      if (child >= bvh.nodes.size()) return "a child beyond the nodes";
      if (child <= i) return "a child before its parent";
      ++reached[child];
      const Aabb& bounds = bvh.nodes[child].bounds;
      if (!bounds.empty() && !node.bounds.contains(bounds)) return "a child outside its parent";
    }
  }
  for (const int count : item_reached)
    if (count != 1) return "an item that is not in one leaf";
  Aabb all;
  for (const Aabb& box : boxes)
    if (!box.empty()) all.extend(box);
  return bvh.nodes[0].bounds == all ? "" : "a root wider than its boxes";
}

void expect_good(const std::vector<Aabb>& boxes, const BvhConfig& config = {}) {
  EXPECT_EQ(complaint(build_bvh(boxes, config), boxes, config), "");
}

std::vector<Aabb> random_boxes(std::size_t count, float reach, float size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-reach, reach), extent(0.0f, size);
  std::vector<Aabb> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 lo(place(random), place(random), place(random));
    boxes.push_back({lo, lo + glm::vec3(extent(random), extent(random), extent(random))});
  }
  return boxes;
}

TEST(Bvh, NoneOneAndTwoBoxes) {
  const Aabb a{{0, 0, 0}, {1, 1, 1}}, b{{5, 5, 5}, {6, 6, 6}};
  expect_good({});
  expect_good({a});
  expect_good({a, b});
  expect_good({a, b}, {.max_leaf_size = 1});
  EXPECT_TRUE(build_bvh(std::vector<Aabb>{a}).nodes[0].leaf());
  EXPECT_EQ(build_bvh(std::vector<Aabb>{a, b}, {.max_leaf_size = 1}).nodes.size(), 3u);
}

TEST(Bvh, EqualBoxes) { expect_good(std::vector<Aabb>(10000, Aabb{{1, 2, 3}, {4, 5, 6}})); }

TEST(Bvh, EqualPoints) { expect_good(std::vector<Aabb>(1000, Aabb{{1, 2, 3}, {1, 2, 3}}), {.max_leaf_size = 1}); }

TEST(Bvh, ConcentricBoxes) {
  std::vector<Aabb> boxes;
  for (int i = 1; i <= 2000; ++i) boxes.push_back({glm::vec3(-i), glm::vec3(i)});
  expect_good(boxes);
}

TEST(Bvh, EmptyBoxesNeverWiden) {
  expect_good(std::vector<Aabb>(100));
  std::vector<Aabb> boxes = random_boxes(500, 10, 1, 3);
  for (std::size_t i = 0; i < boxes.size(); i += 3) boxes[i] = {};
  for (Aabb& box : boxes)
    if (!box.empty())
      box = {box.lo + 1000.0f, box.hi + 1000.0f};  // far from the origin, where an empty box must not be
  expect_good(boxes);
}

TEST(Bvh, LineOfBoxesEachTwiceAsFar) {
  std::vector<Aabb> boxes;
  for (int i = -60; i < 60; ++i) boxes.push_back({glm::vec3(std::ldexp(1.0f, i)), glm::vec3(std::ldexp(1.1f, i))});
  expect_good(boxes, {.max_leaf_size = 1});
}

TEST(Bvh, FlatAndHugeBoxes) {
  std::vector<Aabb> boxes = random_boxes(300, 100, 5, 4);
  for (Aabb& box : boxes) box.hi.y = box.lo.y = 0.0f;
  boxes.push_back({glm::vec3(-1e18f), glm::vec3(1e18f)});
  boxes.push_back({glm::vec3(1e30f), glm::vec3(1e30f)});
  boxes.push_back({glm::vec3(-3e38f), glm::vec3(-2e38f)});
  boxes.push_back({glm::vec3(2e38f), glm::vec3(3e38f)});
  expect_good(boxes, {.max_leaf_size = 1});
}

TEST(Bvh, EveryConfig) {
  const std::vector<Aabb> boxes = random_boxes(3000, 100, 5, 5);
  for (const int leaf : {1, 2, 4, 8, 255})
    for (const int bins : {2, 3, 16, 64}) expect_good(boxes, {.max_leaf_size = leaf, .bins = bins});
}

// Beyond some number of boxes a tree over groups of neighbours comes first.
TEST(Bvh, ManyBoxes) {
  std::vector<Aabb> boxes = random_boxes(40000, 1000, 5, 9);
  for (const int leaf : {1, 4, 255}) expect_good(boxes, {.max_leaf_size = leaf});
  for (std::size_t i = 0; i < boxes.size(); i += 7) boxes[i] = {};
  expect_good(boxes);
  boxes[5] = {glm::vec3(-3e38f), glm::vec3(-2e38f)};
  boxes[8] = {glm::vec3(2e38f), glm::vec3(3e38f)};
  expect_good(boxes);
  expect_good(std::vector<Aabb>(40000, Aabb{{1, 2, 3}, {4, 5, 6}}));
  expect_good(std::vector<Aabb>(40000));
}

TEST(Bvh, OneFarBoxAmongManySpoilsNothing) {
  std::vector<Aabb> boxes = random_boxes(40000, 1000, 5, 9);
  const auto cost = [&] {
    const Bvh bvh = build_bvh(boxes);
    double sum = 0;
    for (const BvhNode& node : bvh.nodes)
      if (node.bounds.hi.x < 2000.0f) sum += static_cast<double>(node.bounds.half_area()) * std::max(node.count, 1u);
    return sum;
  };
  const double without = cost();
  boxes.back() = {glm::vec3(1e8f), glm::vec3(2e8f)};  // now all others share a cell
  EXPECT_LT(cost(), 1.5 * without);
}

TEST(Bvh, LargeBoxesAmongManySmallOnesSpoilNothing) {
  std::vector<Aabb> boxes = random_boxes(40000, 1000, 5, 9);
  const auto cost = [&](bool grouped) {
    const Bvh bvh = build_bvh(boxes, {.grouped = grouped});
    double sum = 0;
    for (const BvhNode& node : bvh.nodes)
      sum += static_cast<double>(node.bounds.half_area()) * std::max(node.count, 1u);
    return sum;
  };
  for (std::size_t i = 0; i < boxes.size(); i += 100) boxes[i] = {boxes[i].lo - 300.0f, boxes[i].hi + 300.0f};
  EXPECT_EQ(complaint(build_bvh(boxes), boxes, {}), "");
  EXPECT_LT(cost(true), 1.1 * cost(false));
}

TEST(Bvh, SameForEveryNumberOfThreads) {
  const std::vector<Aabb> boxes = random_boxes(200000, 1000, 5, 6);
  const auto build = [&](int threads) {
    const ThreadLimit limit(threads);
    return build_bvh(boxes);
  };
  const Bvh one = build(1);
  EXPECT_EQ(complaint(one, boxes, {}), "");
  for (const int threads : {2, 3, 8}) {
    const Bvh many = build(threads);
    EXPECT_EQ(one.items, many.items) << threads;
    ASSERT_EQ(one.nodes.size(), many.nodes.size()) << threads;
    for (std::size_t i = 0; i < one.nodes.size(); ++i) {
      ASSERT_EQ(one.nodes[i].bounds, many.nodes[i].bounds) << i;
      ASSERT_EQ(one.nodes[i].first, many.nodes[i].first) << i;
      ASSERT_EQ(one.nodes[i].count, many.nodes[i].count) << i;
    }
  }
}

TEST(Bvh, FindsWhatOverlapsAndLooksAtLittleElse) {
  const std::vector<Aabb> boxes = random_boxes(20000, 1000, 5, 7);
  const Bvh bvh = build_bvh(boxes);
  const Aabb query{{-50, -50, -50}, {50, 50, 50}};
  std::vector<std::uint32_t> found, expected, stack{0};
  std::size_t visited = 0;
  while (!stack.empty()) {
    const BvhNode& node = bvh.nodes[stack.back()];
    stack.pop_back();
    ++visited;
    if (!node.bounds.overlaps(query)) continue;
    if (!node.leaf()) {
      stack.push_back(node.first);
      stack.push_back(node.first + 1);
      continue;
    }
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k)
      if (boxes[bvh.items[k]].overlaps(query)) found.push_back(bvh.items[k]);
  }
  for (std::uint32_t i = 0; i < boxes.size(); ++i)
    if (boxes[i].overlaps(query)) expected.push_back(i);
  std::sort(found.begin(), found.end());
  EXPECT_FALSE(expected.empty());
  EXPECT_EQ(found, expected);
  EXPECT_LT(visited, 200u) << "of " << bvh.nodes.size() << " nodes; " << expected.size() << " boxes overlap";
}

RC_GTEST_PROP(BvhProperty, AnyBoxes, ()) {
  std::vector<Aabb> boxes;
  const int count = *rc::gen::inRange(0, 80);
  const double reach = *rc::gen::element(0.0, 1.0, 1e6), size = *rc::gen::element(0.0, 0.1, 1e6);
  for (int i = 0; i < count; ++i) boxes.push_back(*rc::gen::inRange(0, 5) == 0 ? Aabb{} : properties::box(reach, size));
  BvhConfig config;
  config.max_leaf_size = *rc::gen::inRange(1, 6);
  config.bins = *rc::gen::inRange(2, 65);
  const std::string wrong = complaint(build_bvh(boxes, config), boxes, config);
  RC_ASSERT(wrong == "");
}

TEST(Bvh, ItemsBelowANodeAreThoseOfItsLeaves) {
  std::mt19937 engine(5);
  std::vector<Aabb> boxes;
  for (int i = 0; i < 300; ++i) {
    const glm::vec3 at(engine() % 100, engine() % 100, engine() % 100);
    boxes.push_back({at, at + 1.0f});
  }
  const Bvh bvh = build_bvh(boxes);
  EXPECT_EQ(items_below(bvh, 0).begin, 0u);
  EXPECT_EQ(items_below(bvh, 0).end, 300u);
  for (std::uint32_t i = 0; i < bvh.nodes.size(); ++i) {
    const BvhNode& node = bvh.nodes[i];
    const ItemRange range = items_below(bvh, i);
    if (node.leaf()) {
      EXPECT_EQ(range.begin, node.first);
      EXPECT_EQ(range.end, node.first + node.count);
      continue;
    }
    const ItemRange left = items_below(bvh, node.first), right = items_below(bvh, node.first + 1);
    EXPECT_EQ(range.begin, left.begin);
    EXPECT_EQ(left.end, right.begin);
    EXPECT_EQ(range.end, right.end);
  }
}

TEST(Bvh, RefitFollowsMovedGrownAndEmptiedBoxes) {
  for (const std::size_t count : {1, 2, 5, 400}) {
    std::vector<Aabb> boxes = random_boxes(count, 50, 4, 7);
    Bvh bvh = build_bvh(boxes);
    const std::vector<Aabb> moved = random_boxes(count, 80, 9, 8);
    for (std::size_t i = 0; i < count; ++i) boxes[i] = i % 5 == 3 ? Aabb() : moved[i];
    refit(bvh, boxes);
    EXPECT_EQ(complaint(bvh, boxes, {}), "");
  }
  Bvh none;
  refit(none, {});
  EXPECT_TRUE(none.nodes.empty());
}

TEST(Bvh, RefitAfterNothingMovedChangesNothing) {
  std::vector<Aabb> boxes = random_boxes(3000, 50, 4, 7);
  boxes[17] = Aabb();
  const Bvh built = build_bvh(boxes);
  Bvh same = built;
  refit(same, boxes);
  for (std::size_t i = 0; i < built.nodes.size(); ++i) EXPECT_EQ(built.nodes[i].bounds, same.nodes[i].bounds) << i;
}

struct NamedBuilder {
  const char* name;
  Bvh (*build)(std::span<const Aabb>, const BvhConfig&);
};
constexpr NamedBuilder builders[] = {
    {"sah", build_bvh}, {"linear", build_bvh_linear}, {"median", build_bvh_median}, {"extent", build_bvh_extent}};

TEST(BvhBuilders, EveryBoxOnceWithinItsNodes) {
  Random random(2);
  for (const std::size_t n : {0, 1, 2, 5, 8, 9, 63, 64, 65, 1000, 5000})
    for (int kind = 0; kind < 4; ++kind) {
      std::vector<Aabb> boxes;
      for (std::size_t i = 0; i < n; ++i) {
        const glm::vec3 p = kind == 1 ? glm::vec3(1) : glm::vec3(10.0 * random.direction());
        Aabb box{p, p + static_cast<float>(random.power_of_two_range(-9, 3)) * glm::abs(glm::vec3(random.direction()))};
        if (kind == 2 && i % 3 == 0) box = {};
        if (kind == 3) box = {{static_cast<float>(i), 0, 0}, {static_cast<float>(i), 0, 0}};
        boxes.push_back(box);
      }
      for (const auto& [name, build] : builders)
        for (const int leaf : {1, 4, 8})
          EXPECT_EQ(complaint(build(boxes, {.max_leaf_size = leaf}), boxes, {.max_leaf_size = leaf}), "")
              << name << " of " << n << " boxes of kind " << kind << ", leaves of " << leaf;
    }
}

}  // namespace
}  // namespace sightline
