#include "sightline/index/trace.hpp"

namespace sightline {
namespace {

float largest(const glm::vec3& v) { return std::max({v.x, v.y, v.z}); }

/// Parameter at which the ray enters the box, or a negative number if it starts inside; false if it passes by.
bool enter_box(const Ray& ray, const glm::dvec3& lo, const glm::dvec3& hi, double& enter) {
  double leave = std::numeric_limits<double>::infinity();
  enter = -leave;
  for (int axis = 0; axis < 3; ++axis) {
    const double from = lo[axis] - static_cast<double>(ray.origin[axis]);
    const double to = hi[axis] - static_cast<double>(ray.origin[axis]);
    const auto d = static_cast<double>(ray.direction[axis]);
    if (d == 0.0) {
      if (from > 0.0 || to < 0.0) return false;
      continue;
    }
    enter = std::max(enter, (d > 0.0 ? from : to) / d);
    leave = std::min(leave, (d > 0.0 ? to : from) / d);
  }
  return enter <= leave && leave >= 0.0;
}

}  // namespace

TraceSpace trace_space(const Aabb& bounds) {
  TraceSpace space;
  space.bounds = bounds;
  if (bounds.empty()) return space;
  // Coordinates relative to an origin are at most twice the largest extent; shearing loses less than 8 * 2^-24 of that.
  const float extent = largest(bounds.extent());
  space.slack = std::max(extent * 0x1p-20f, 1e-30f);
  space.reach = {bounds.lo - extent, bounds.hi + extent};
  // Over an extent and a direction at their limits such a component still moves a ray by less than the slack.
  space.least = extent * 1e-37f;
  return space;
}

bool approach(const Ray& ray, const TraceSpace& space, TraceRay& prepared) {
  if (space.bounds.empty()) return false;
  const glm::dvec3 margin(0.5 * static_cast<double>(largest(space.bounds.extent())));
  double enter = 0.0;
  if (!enter_box(ray, glm::dvec3(space.bounds.lo) - margin, glm::dvec3(space.bounds.hi) + margin, enter)) return false;
  prepared.moved = std::max(enter, 0.0);
  prepared.origin = glm::vec3(point_at(ray, prepared.moved));
  prepared.t_near = static_cast<float>(std::max(0.0, static_cast<double>(ray.t_near) - prepared.moved));
  prepared.t_far = static_cast<float>(static_cast<double>(ray.t_far) - prepared.moved);
  return true;
}

RayHit trace_brute(const TriangleSoup& soup, const TraceSpace& space, const Ray& ray, TraceCounters& counters) {
  ++counters.rays;
  TraceRay prepared;
  if (!prepare(ray, space, prepared)) return {};
  RayHit best{prepared.t_far, no_triangle};
  for (std::uint32_t i = 0; i < soup.size(); ++i) (void)try_triangle(prepared, soup, i, best);
  counters.tests += soup.size();
  return finish(prepared, best);
}

}  // namespace sightline
