#include "sightline/geometry/obb.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sightline/geometry/pca.hpp"

namespace sightline {
namespace {

double half_area(const Obb& box) {
  const glm::dvec3 r(box.radii);
  return 4.0 * (r.x * r.y + r.y * r.z + r.z * r.x);
}

/// Smaller in volume, or in surface where both are flat.
bool smaller(const Obb& a, const Obb& b) {
  const double va = volume(a), vb = volume(b);
  if (std::abs(va - vb) > 1e-6 * std::max(va, vb)) return va < vb;
  return half_area(a) < half_area(b);
}

/// The directions u of the edges of the convex polygon that the points make in the plane of `normal`.
Obb best_in_plane(std::span<const glm::vec3> points, const glm::dvec3& normal) {
  const glm::dvec3 helper = std::abs(normal.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 u = glm::normalize(glm::cross(helper, normal)), v = glm::cross(normal, u);
  std::vector<glm::dvec2> flat;
  for (const glm::vec3& p : points) flat.emplace_back(glm::dot(glm::dvec3(p), u), glm::dot(glm::dvec3(p), v));
  const std::vector<std::uint32_t> corners = convex_polygon(flat);
  double best = std::numeric_limits<double>::infinity();
  glm::dvec2 along(1.0, 0.0);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec2 edge = flat[corners[(i + 1) % corners.size()]] - flat[corners[i]];
    const double length = glm::length(edge);
    if (!(length > 0.0)) continue;
    const glm::dvec2 e = edge / length, f(-e.y, e.x);
    glm::dvec2 lo(std::numeric_limits<double>::infinity()), hi(-lo);
    for (const std::uint32_t c : corners) {
      const glm::dvec2 q(glm::dot(flat[c], e), glm::dot(flat[c], f));
      lo = glm::min(lo, q);
      hi = glm::max(hi, q);
    }
    const double area = (hi.x - lo.x) * (hi.y - lo.y);
    if (area < best) {
      best = area;
      along = e;
    }
  }
  const glm::dvec3 first = glm::normalize(along.x * u + along.y * v);
  return box_along(points, glm::dmat3(first, glm::cross(normal, first), normal));
}

}  // namespace

Obb box_along(std::span<const glm::vec3> points, const glm::dmat3& axes) {
  Obb box;
  if (points.empty()) return box;
  box.axes = glm::mat3(axes);
  const glm::dmat3 frame(box.axes);  // as rounded
  glm::dvec3 lo(std::numeric_limits<double>::infinity()), hi(-lo);
  for (const glm::vec3& p : points) {
    const glm::dvec3 q = glm::transpose(frame) * glm::dvec3(p);
    lo = glm::min(lo, q);
    hi = glm::max(hi, q);
  }
  const glm::dvec3 middle = 0.5 * (lo + hi), radii = 0.5 * (hi - lo);
  box.centre = glm::vec3(glm::inverse(glm::transpose(frame)) * middle);
  // Rounding of the centre and of axes that are orthonormal only up to a float.
  const double slack = 0x1p-21 * (glm::length(glm::dvec3(box.centre)) + glm::length(radii));
  box.radii = glm::vec3(radii + glm::dvec3(slack));
  return box;
}

Obb pca_box(std::span<const glm::vec3> points) { return box_along(points, principal_axes(points).axes); }

Obb fitted_box(const ConvexHull& hull) {
  Obb best = box_along(hull.vertices, glm::dmat3(1.0));
  if (const Obb other = pca_box(hull.vertices); smaller(other, best)) best = other;
  const std::size_t stride = std::max<std::size_t>(1, hull.faces.size() / 256);
  for (std::size_t f = 0; f < hull.faces.size(); f += stride) {
    const glm::dvec3 a(hull.vertices[hull.faces[f].x]), b(hull.vertices[hull.faces[f].y]),
        c(hull.vertices[hull.faces[f].z]);
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double length = glm::length(normal);
    if (!(length > 0.0)) continue;
    if (const Obb other = best_in_plane(hull.vertices, normal / length); smaller(other, best)) best = other;
  }
  best.radii += glm::vec3(hull.slack);
  return best;
}

double volume(const Obb& box) {
  const glm::dvec3 r(box.radii);
  return r.x < 0.0 ? 0.0 : 8.0 * r.x * r.y * r.z;
}

double surface(const Obb& box) { return box.radii.x < 0.0f ? 0.0 : 2.0 * half_area(box); }

Containment classify(const Frustum& frustum, const Obb& box) {
  if (box.radii.x < 0.0f) return Containment::outside;
  Containment result = Containment::inside;
  for (int i = 0; i < frustum.count; ++i) {
    const Plane& plane = frustum.planes[static_cast<std::size_t>(i)];
    const glm::vec3 along(std::abs(glm::dot(plane.normal, box.axes[0])), std::abs(glm::dot(plane.normal, box.axes[1])),
                          std::abs(glm::dot(plane.normal, box.axes[2])));
    const float radius = 1.000001f * glm::dot(along, box.radii),
                distance = glm::dot(plane.normal, box.centre) + plane.offset;
    if (distance < -radius) return Containment::outside;
    if (distance < radius) result = Containment::intersecting;
  }
  return result;
}

}  // namespace sightline
