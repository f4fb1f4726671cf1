// Ray against triangle, three ways: sums of partial areas (checklist 13.07) and barycentric coordinates (13.08-13.10),
// as on the slides, and watertight (Woop, Benthin and Wald 2013), which the tracing structures use.
#pragma once

#include <optional>

#include "sightline/geometry/ray.hpp"

namespace sightline {

/// The hit point is alpha * a + beta * b + gamma * c, with alpha + beta + gamma = 1; t as for the ray.
struct TriangleHit {
  double t, alpha, beta, gamma;
};

/// Inside if the three partial areas add up to the whole, up to `tolerance` times the whole: the tolerance is needed
/// because of rounding, and with it triangles overlap at their edges (13.07). No area, no ray, or parallel: no hit.
std::optional<TriangleHit> hit_triangle_areas(const Ray& ray, const glm::vec3& a, const glm::vec3& b,
                                              const glm::vec3& c, double tolerance = 1e-9);

/// Inside if alpha, beta and gamma, quotients of oriented areas, lie in [0, 1] (13.10). Rays through a shared edge may
/// miss both its triangles by rounding. No area, no ray, or parallel: no hit.
std::optional<TriangleHit> hit_triangle_barycentric(const Ray& ray, const glm::vec3& a, const glm::vec3& b,
                                                    const glm::vec3& c);

/// What a watertight test needs of a ray: its largest axis z, the other two, and the shear that makes the ray the z
/// axis of a space in which every vertex has the same place whichever triangle it belongs to.
struct Shear {
  int x, y, z;
  float origin_x, origin_y, origin_z;  // along these axes
  float shear_x, shear_y, scale_z;
};

/// The ray must be one (is_ray).
inline void set_shear(Shear& s, const glm::vec3& origin, const glm::vec3& direction) {
  const glm::vec3 size = magnitudes(direction);
  const int middle = static_cast<int>(size.y > size.x), last = static_cast<int>(size.z > std::max(size.x, size.y));
  s.z = 2 * last | (middle & ~last);
  // The axes after z, two bits for each z: a choice would be a branch.
  s.x = (0b00'10'01 >> (2 * s.z)) & 3;
  s.y = (0b01'00'10 >> (2 * s.z)) & 3;
  // By pointer: the vectors' own operator[] branches on the axis, which is different for every ray.
  const float *o = &origin.x, *d = &direction.x;
  s.origin_x = o[s.x];
  s.origin_y = o[s.y];
  s.origin_z = o[s.z];
  s.shear_x = d[s.x] / d[s.z];
  s.shear_y = d[s.y] / d[s.z];
  s.scale_z = 1.0f / d[s.z];
}
inline Shear shear_of(const glm::vec3& origin, const glm::vec3& direction) {
  Shear s;
  set_shear(s, origin, direction);
  return s;
}

/// A triangle in the space of a shear, in which the ray is the z axis (whose scale the shear's scale_z is).
struct ShearedTriangle {
  float ax, ay, az, bx, by, bz, cx, cy, cz;
};
[[gnu::always_inline]] inline ShearedTriangle sheared(const Shear& s, const float* a, const float* b, const float* c) {
  const float az = a[s.z] - s.origin_z, bz = b[s.z] - s.origin_z, cz = c[s.z] - s.origin_z;
  return {(a[s.x] - s.origin_x) - s.shear_x * az, (a[s.y] - s.origin_y) - s.shear_y * az, az,
          (b[s.x] - s.origin_x) - s.shear_x * bz, (b[s.y] - s.origin_y) - s.shear_y * bz, bz,
          (c[s.x] - s.origin_x) - s.shear_x * cz, (c[s.y] - s.origin_y) - s.shear_y * cz, cz};
}

/// Weights (not normalised, all of one sign, sum not 0) of the corners at which the ray's line meets the triangle, and
/// its parameter t, which lies between those of the corners.
struct ShearedHit {
  double u, v, w, t;
};

/// Watertight: of two triangles with a common edge (bit by bit the same corners) a line through it meets at least one.
/// Vertices are sheared in float; edge functions of the results are taken in double, where their sign is exact, so the
/// line is inside exactly if the sheared triangle holds the origin. False if it is not, or the sheared triangle is
/// flat.
[[gnu::always_inline]] inline bool hit_sheared(const ShearedTriangle& p, float scale_z, ShearedHit& hit) {
  const auto cross = [](float px, float py, float qx, float qy) {
    return static_cast<double>(px) * static_cast<double>(qy) - static_cast<double>(py) * static_cast<double>(qx);
  };
  hit.u = cross(p.cx, p.cy, p.bx, p.by);
  hit.v = cross(p.ax, p.ay, p.cx, p.cy);
  hit.w = cross(p.bx, p.by, p.ax, p.ay);
  if ((hit.u < 0.0 || hit.v < 0.0 || hit.w < 0.0) && (hit.u > 0.0 || hit.v > 0.0 || hit.w > 0.0)) return false;
  const double sum = hit.u + hit.v + hit.w;
  if (!(sum != 0.0)) return false;
  const double depth =
      hit.u * static_cast<double>(p.az) + hit.v * static_cast<double>(p.bz) + hit.w * static_cast<double>(p.cz);
  hit.t = depth / sum * static_cast<double>(scale_z);
  return true;
}
[[gnu::always_inline]] inline bool hit_sheared(const Shear& s, const float* a, const float* b, const float* c,
                                               ShearedHit& hit) {
  return hit_sheared(sheared(s, a, b, c), s.scale_z, hit);
}

/// Watertight test within the ray's interval; no ray or no area as seen by the ray: no hit.
std::optional<TriangleHit> hit_triangle_watertight(const Ray& ray, const glm::vec3& a, const glm::vec3& b,
                                                   const glm::vec3& c);

}  // namespace sightline
