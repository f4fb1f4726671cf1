// What all tracing structures share: the prepared ray, the hit, and the one test of a triangle that decides. Because
// the test is the same and nothing is pruned that it would accept, every structure gives the same hit, bit by bit: the
// smallest t, at equal t the lowest place in the soup. Checklist 13.01, 13.13; E24.
#pragma once

#include <cstdint>
#include <span>

#include "sightline/geometry/no_triangle.hpp"
#include "sightline/geometry/ray.hpp"
#include "sightline/geometry/ray_triangle.hpp"
#include "sightline/index/triangle_soup.hpp"

namespace sightline {

/// The nearest triangle met, by its place in the soup; no_triangle if there is none.
struct RayHit {
  float t = std::numeric_limits<float>::infinity();
  std::uint32_t triangle = no_triangle;
  [[nodiscard]] bool found() const { return triangle != no_triangle; }
  friend bool operator==(const RayHit&, const RayHit&) = default;
};

/// The work of tracing. Added to, never reset.
struct TraceCounters {
  std::uint64_t rays = 0;
  std::uint64_t nodes = 0;  // nodes or cells visited
  std::uint64_t tests = 0;  // triangles tested
  /// If set, what was tested is appended: places of triangles, of a Bvh8 its leaves. To run the tests again by
  /// themselves (checklist 13.12).
  std::vector<std::uint32_t>* tested = nullptr;
};

/// The space that the triangles of a soup fill, and how far things are moved to the safe side in it.
struct TraceSpace {
  Aabb bounds;
  /// Metres. A line that the triangle test accepts comes closer than this to the triangle; for origins no farther
  /// outside than the largest extent of the bounds, which prepare() sees to.
  float slack = 0.0f;
  /// The bounds, one extent larger on every side: rays from elsewhere are moved.
  Aabb reach;
  /// Smaller components of a direction count as this, so that no parameter within reach is infinite.
  float least = 0.0f;
};
TraceSpace trace_space(const Aabb& bounds);

/// A ray made ready for a soup: origin moved near to the bounds if it was far away, reciprocal direction without
/// infinities, slack as a parameter per axis. t here counts from the moved origin.
struct TraceRay {
  Shear shear;
  glm::vec3 origin, direction, inverse;
  glm::vec3 slack;  // space.slack * |inverse|
  float t_near, t_far;
  double moved;  // parameter of the moved origin
};

/// Moves the origin of a ray from outside the reach to before the bounds; false if it passes them far away, or they are
/// empty. Sets origin, moved and the interval.
bool approach(const Ray& ray, const TraceSpace& space, TraceRay& prepared);

/// False if the ray meets nothing for certain: is no ray (NaN, ...), or passes the bounds far away.
[[gnu::always_inline]] inline bool prepare(const Ray& ray, const TraceSpace& space, TraceRay& prepared) {
  if (!is_ray(ray)) return false;
  prepared.origin = ray.origin;
  prepared.direction = ray.direction;
  prepared.moved = 0.0;
  prepared.t_near = std::max(0.0f, ray.t_near);
  prepared.t_far = ray.t_far;
  if (!space.reach.contains(ray.origin) && !approach(ray, space, prepared)) return false;
  if (!(prepared.t_near <= prepared.t_far)) return false;
  set_shear(prepared.shear, prepared.origin, ray.direction);
  // A component so small that it moves the ray by less than the slack over the whole scene counts as that small number.
  const glm::vec3 size = magnitudes(ray.direction);
  const float least = std::max(std::max({size.x, size.y, size.z}) * 1e-12f, space.least);
  for (int axis = 0; axis < 3; ++axis) {
    prepared.inverse[axis] = 1.0f / std::copysign(std::max(size[axis], least), ray.direction[axis]);
    prepared.slack[axis] = space.slack * std::abs(prepared.inverse[axis]);
  }
  return true;
}

/// The hit in the parameter of the ray as it was given.
inline RayHit finish(const TraceRay& ray, const RayHit& hit) {
  if (!hit.found()) return {};
  return {static_cast<float>(ray.moved + static_cast<double>(hit.t)), hit.triangle};
}

/// Interval in which the ray passes a box, widened by the slack: whatever a triangle in the box is hit at lies in it.
inline void pass_box(const TraceRay& ray, const glm::vec3& lo, const glm::vec3& hi, float& enter, float& leave) {
  enter = ray.t_near;
  leave = ray.t_far;
  for (int axis = 0; axis < 3; ++axis) {
    const float from_lo = (lo[axis] - ray.origin[axis]) * ray.inverse[axis];
    const float from_hi = (hi[axis] - ray.origin[axis]) * ray.inverse[axis];
    const bool forward = ray.inverse[axis] >= 0.0f;
    enter = std::max(enter, (forward ? from_lo : from_hi) - ray.slack[axis]);
    leave = std::min(leave, (forward ? from_hi : from_lo) + ray.slack[axis]);
  }
}

/// The test that decides: watertight, with t held within the passage of the ray through the triangle's box (edge-on a
/// computed t may lie anywhere on the triangle). True, and `best` replaced, if the triangle is hit within [t_near,
/// best.t] and nearer than best, or as near and of a lower place. `p` is the triangle of a, b and c as the ray's shear
/// has it.
[[gnu::always_inline]] inline bool try_triangle(const TraceRay& ray, const ShearedTriangle& p, const float* a,
                                                const float* b, const float* c, std::uint32_t place, RayHit& best) {
  ShearedHit hit{};
  if (!hit_sheared(p, ray.shear.scale_z, hit)) return false;
  float enter = -std::numeric_limits<float>::infinity(), leave = -enter;
  for (int axis = 0; axis < 3; ++axis) {
    const float lo = (std::min({a[axis], b[axis], c[axis]}) - ray.origin[axis]) * ray.inverse[axis];
    const float hi = (std::max({a[axis], b[axis], c[axis]}) - ray.origin[axis]) * ray.inverse[axis];
    enter = std::max(enter, std::min(lo, hi) - ray.slack[axis]);
    leave = std::min(leave, std::max(lo, hi) + ray.slack[axis]);
  }
  const float t = std::max(enter, std::min(leave, static_cast<float>(hit.t)));
  if (!(t >= ray.t_near && t <= best.t) || (t == best.t && place >= best.triangle)) return false;
  best = {t, place};
  return true;
}
[[gnu::always_inline]] inline bool try_triangle(const TraceRay& ray, const float* a, const float* b, const float* c,
                                                std::uint32_t place, RayHit& best) {
  return try_triangle(ray, sheared(ray.shear, a, b, c), a, b, c, place, best);
}

inline bool try_triangle(const TraceRay& ray, const TriangleSoup& soup, std::uint32_t place, RayHit& best) {
  const glm::vec3* corners = soup.triangle(place);
  return try_triangle(ray, &corners[0].x, &corners[1].x, &corners[2].x, place, best);
}

/// Every triangle, every time (checklist 13.12): the reference of all structures, and a peer among them.
RayHit trace_brute(const TriangleSoup& soup, const TraceSpace& space, const Ray& ray, TraceCounters& counters);

/// The ray of a segment: t = 0 at a, 1 at b; `clearance` is left out at both ends (a share of the length), so that end
/// points may lie on surfaces.
inline Ray segment_ray(const glm::vec3& a, const glm::vec3& b, float clearance) {
  return {a, clearance, b - a, 1.0f - clearance};
}
inline constexpr float default_clearance = 1e-4f;

}  // namespace sightline
