// Nodes of a hierarchy, nearest first; equal ones by number, so that the order is the same on every machine.
#pragma once

#include <cstdint>
#include <queue>
#include <vector>

namespace sightline::gl {

struct QueuedNode {
  float distance2;
  std::uint32_t node;
  friend bool operator<(const QueuedNode& a, const QueuedNode& b) {  // std::priority_queue serves the largest
    return a.distance2 != b.distance2 ? a.distance2 > b.distance2 : a.node > b.node;
  }
};

using NodeQueue = std::priority_queue<QueuedNode>;

}  // namespace sightline::gl
