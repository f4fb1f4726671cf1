// Several small boxes instead of one large: fewer nodes are called visible that are not, at more surface to fill
// (checklist 24.01-24.06, E49).
#pragma once

#include <span>
#include <vector>

#include "sightline/index/bvh.hpp"

namespace sightline::gl {

struct TightBoundsConfig {
  double sigma = 1.4;  // the boxes' surfaces together, relative to the surface of the node's own box; below 1: one box
  int depth = 3;       // levels below the node, so at most 2^depth boxes
};

/// Boxes for every node of a hierarchy, each set covering all that is below its node.
class TightBounds {
 public:
  void build(const Bvh& bvh, const TightBoundsConfig& config);
  [[nodiscard]] std::span<const Aabb> boxes(std::uint32_t node) const {
    return std::span(boxes_).subspan(first_[node], first_[node + 1] - first_[node]);
  }
  [[nodiscard]] std::size_t box_count() const { return boxes_.size(); }

 private:
  std::vector<std::uint32_t> first_{0u};
  std::vector<Aabb> boxes_;
};

}  // namespace sightline::gl
