// What an occlusion culler may ask about instead of an object's one box: tight boxes in world space (checklist 24). For
// any culler: an object may be seen only if one of its boxes may.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "sightline/index/tight_bounds.hpp"
#include "sightline/scene/scene.hpp"

namespace sightline {

class OccludeeBounds {
 public:
  OccludeeBounds() = default;
  /// sigma 1 gives the objects' own boxes. Per mesh the triangles are clustered once; per object each cluster's corners
  /// are placed, or, in scenes of more than 8 million triangles, the corners of its box.
  OccludeeBounds(const Scene& scene, const TightBoundsConfig& config);
  /// Places the clusters where the objects of the same scene are now.
  void follow(const Scene& scene);

  [[nodiscard]] bool empty() const { return first_.empty(); }
  /// World-space boxes that hold all of the object, rounded outwards.
  [[nodiscard]] std::span<const Aabb> boxes(ObjectId id) const {
    return std::span<const Aabb>(boxes_).subspan(first_[id], first_[id + 1] - first_[id]);
  }
  /// Those of all objects, in the order of their ids; the first of an object, or of the one after the last.
  [[nodiscard]] std::span<const Aabb> boxes() const { return boxes_; }
  [[nodiscard]] std::uint32_t first(ObjectId id) const { return first_[id]; }
  /// True if test(box) is for any of the object's boxes.
  template <class Test>
  [[nodiscard]] bool any(ObjectId id, Test&& test) const {
    const auto list = boxes(id);
    return std::any_of(list.begin(), list.end(), test);
  }
  [[nodiscard]] std::size_t bytes() const {
    return boxes_.size() * sizeof(Aabb) + first_.size() * sizeof(std::uint32_t);
  }
  [[nodiscard]] std::size_t count() const { return boxes_.size(); }

 private:
  std::vector<TightBounds> meshes_;  // by mesh id
  std::vector<Aabb> boxes_;
  std::vector<std::uint32_t> first_;
};

}  // namespace sightline
