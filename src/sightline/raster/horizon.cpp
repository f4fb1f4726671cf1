#include "sightline/raster/horizon.hpp"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

constexpr double widest = 8;       // columns end where a direction is 83 degrees off the plan direction
constexpr double steepest = 0.05;  // length of the plan direction below which there is no horizon

}  // namespace

bool Horizon::begin(const View& view, int columns) {
  plan_ = {};
  const glm::dvec3 direction = view_direction(view);
  plan_.climb = direction.y;
  plan_.level = glm::length(glm::dvec2(direction.x, direction.z));
  if (plan_.level < steepest) return false;
  plan_.eye = view.eye;
  plan_.forward = glm::dvec2(direction.x, direction.z) / plan_.level;
  plan_.right = {-plan_.forward.y, plan_.forward.x};
  plan_.tilt = plan_.climb / plan_.level;
  plan_.near = view.near;
  plan_.perspective = view.projection == Projection::perspective;
  double limit = 0;
  for (const double x : {0.0, static_cast<double>(view.width)})
    for (const double y : {0.0, static_cast<double>(view.height)}) {
      const PixelRay ray = pixel_ray(view, x, y);
      const glm::dvec3 d = plan_.perspective ? ray.direction : ray.origin - view.eye;
      const double across = glm::dot(plan_.right, glm::dvec2(d.x, d.z)),
                   along = glm::dot(plan_.forward, glm::dvec2(d.x, d.z));
      if (!plan_.perspective)
        limit = std::max(limit, std::abs(across));
      else if (along * widest > std::abs(across))
        limit = std::max(limit, std::abs(across) / along);
      else
        plan_.open_sides = true;
    }
  if (plan_.open_sides) limit = widest;
  if (!(limit > 0)) return false;
  plan_.limit = limit * (1 + 1e-9);
  plan_.per_u = columns / (2 * plan_.limit);
  plan_.columns = columns;
  const std::size_t padded = static_cast<std::size_t>(columns) + 8;
  low_.assign(padded, 3e38f);
  high_.assign(padded, -3e38f);
  plan_.low = low_.data();
  plan_.high = high_.data();
  return true;
}

void Horizon::add(const WallFence& fence, const glm::dvec3& offset, double slack) {
  add_fence(plan_, fence.plan,
            {offset.x, offset.z, fence.y0 + offset.y, fence.y1 + offset.y, slack + 1e-7 * glm::length(plan_.eye)},
            scratch_);
}

}  // namespace sightline
