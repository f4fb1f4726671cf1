// What the structures share that keep a triangle in every cell that it touches: testing the triangles of a cell, and
// making a list of places out of those of several cells.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "sightline/index/trace.hpp"

namespace sightline {

/// Triangles that a ray has been tested against lately (E24, mailboxing without memory shared between rays).
class Mailbox {
 public:
  Mailbox() { std::fill(last_, last_ + slots, no_triangle); }
  /// True the first time, and again once another triangle took the slot.
  bool enter(std::uint32_t triangle) {
    std::uint32_t& slot = last_[triangle % slots];
    if (slot == triangle) return false;
    slot = triangle;
    return true;
  }

 private:
  static constexpr std::size_t slots = 32;
  std::uint32_t last_[slots];
};

/// Tests the triangles of a cell. True if one became the best hit; of them, with `any`, the first ends the test.
template <bool any>
bool test_items(std::span<const std::uint32_t> items, const TriangleSoup& soup, const TraceRay& ray, Mailbox& mailbox,
                TraceCounters& counters, RayHit& best) {
  bool found = false;
  for (const std::uint32_t triangle : items) {
    if (!mailbox.enter(triangle)) continue;
    ++counters.tests;
    if (counters.tested != nullptr) counters.tested->push_back(triangle);
    found |= try_triangle(ray, soup, triangle, best);
    if (any && found) return true;
  }
  return found;
}

/// Down a tree of cells from the step `now` on: the best hit. split(node, now, stack, top) leads into the first child
/// of an inner node and puts what comes later onto the stack; false at a leaf. A step knows its node and where the ray
/// enters.
template <bool any, std::size_t room, class Tree, class Step, class Split>
RayHit walk_cells(const Tree& tree, const TriangleSoup& soup, const TraceRay& ray, Step now, TraceCounters& counters,
                  Split&& split) {
  RayHit best{ray.t_far, no_triangle};
  if (!(now.enter <= now.leave)) return best;
  Mailbox mailbox;
  Step stack[room];
  std::size_t top = 0;
  for (;;) {
    ++counters.nodes;
    if (split(tree.nodes[now.node], now, stack, top)) continue;
    if (test_items<any>(tree.items_of(now.node), soup, ray, mailbox, counters, best) && any) return best;
    // Later cells may still hold a nearer hit than one found beyond its cell: the in-cell rule of E24.
    do {
      if (top == 0) return best;
      now = stack[--top];
    } while (now.enter > best.t);
  }
}

/// Each place once, ascending, if take(its corners).
template <class Take>
std::vector<std::uint32_t> unique_places(std::vector<std::uint32_t> found, const TriangleSoup& soup, Take&& take) {
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  std::erase_if(found, [&](std::uint32_t i) { return !take(soup.triangle(i)); });
  return found;
}

/// Triangles that `take(corners)` takes in the leaves of a tree of cells whose cell `keep(cell)` keeps.
template <class Tree, class Keep, class Take>
std::vector<std::uint32_t> query_cells(const Tree& tree, const TriangleSoup& soup, Keep&& keep, Take&& take) {
  struct Task {
    Aabb cell;
    std::uint32_t node;
  };
  std::vector<std::uint32_t> found;
  std::vector<Task> stack;
  if (!tree.nodes.empty()) stack.push_back({tree.bounds, 0});
  while (!stack.empty()) {
    const Task task = stack.back();
    stack.pop_back();
    if (!keep(task.cell)) continue;
    const std::span<const std::uint32_t> items = tree.items_of(task.node);
    found.insert(found.end(), items.begin(), items.end());
    tree.for_each_child(task.node, task.cell,
                        [&](const Aabb& cell, std::uint32_t child) { stack.push_back({cell, child}); });
  }
  return unique_places(std::move(found), soup, take);
}

}  // namespace sightline
