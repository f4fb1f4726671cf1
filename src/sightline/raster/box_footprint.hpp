// Where a box lies in an image: the pixels its projection can touch, and its nearest and farthest distance, all rounded
// to the safe side for an occludee. Shared by the occlusion cullers that keep images of their own.
#pragma once

#include <glm/glm.hpp>

#include "sightline/geometry/aabb.hpp"
#include "sightline/scene/view.hpp"

namespace sightline {

enum class BoxPlace {
  unseen,     // before the near plane or beside the image
  rectangle,  // all of it lies behind the near plane; the rectangle holds its projection
  everywhere  // it reaches before the near plane: nothing can be said, the rectangle is the whole image
};

struct BoxFootprint {
  BoxPlace place = BoxPlace::unseen;
  /// Pixels [x0, x1) x [y0, y1) within the image.
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  /// Distances along the view direction, metres.
  double nearest = 0, farthest = 0;

  [[nodiscard]] int pixels() const { return (x1 - x0) * (y1 - y0); }
  [[nodiscard]] bool overlaps(const BoxFootprint& o) const { return x0 < o.x1 && o.x0 < x1 && y0 < o.y1 && o.y0 < y1; }
};

/// Projects boxes of world space into an image of `width` x `height` pixels, which need not be the view's.
class BoxProjector {
 public:
  BoxProjector() = default;
  BoxProjector(const View& view, int width, int height);
  [[nodiscard]] BoxFootprint project(const Aabb& box) const;

 private:
  glm::dvec3 eye_{0.0}, to_x_{0.0}, to_y_{0.0}, to_w_{0.0};  // world - eye to pixels from the centre, and to distance
  double near_ = 0;
  int width_ = 1, height_ = 1;
  bool perspective_ = true;
};

/// True if something at distance `nearest` or farther lies behind what is hidden beyond `hidden` (both along the view
/// direction), whatever the rounding of either.
inline bool behind(double nearest, float hidden) {
  return nearest - (nearest < 0 ? -nearest : nearest) * 0x1p-19 >= static_cast<double>(hidden);
}

}  // namespace sightline
