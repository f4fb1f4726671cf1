// Occlusion queries (checklist 22.03, E44): boxes drawn without effect, and how many samples of them would have been
// seen. Answers count samples, or tell only whether there was one, which a device may find faster.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "gl/scene_drawing.hpp"

namespace sightline::gl {

class OcclusionQueries {
 public:
  /// `threshold`: samples from which on something counts as seen; above 1 the answers are an approximation (22.19).
  OcclusionQueries(SceneDrawing& drawing, std::uint32_t threshold) : drawing_(drawing), threshold_(threshold) {}
  ~OcclusionQueries();
  OcclusionQueries(const OcclusionQueries&) = delete;
  OcclusionQueries& operator=(const OcclusionQueries&) = delete;

  [[nodiscard]] bool approximate() const { return threshold_ > 1; }

  /// What one query asks: so many of the boxes, one after the other, which stand for so many nodes.
  struct Ask {
    std::uint32_t boxes, nodes;
  };
  /// Issues queries over consecutive boxes; appends their names to `names`. One switch of state for all.
  void issue(std::span<const Aabb> boxes, std::span<const Ask> asks, std::vector<unsigned>& names);
  /// True if the answer can be had without waiting.
  bool available(unsigned name);
  /// The answer, true for seen; waits for it. The name may then be used again.
  bool seen(unsigned name);
  /// As `seen`, and counts it as a blocking wait if the answer was not there.
  bool seen_now(unsigned name);

 private:
  unsigned take_name();
  SceneDrawing& drawing_;
  std::uint32_t threshold_;
  std::vector<unsigned> free_, all_;
};

}  // namespace sightline::gl
