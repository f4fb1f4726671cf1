#include "sightline/geometry/normal_cluster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sightline {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

float below(double value) {
  const auto f = static_cast<float>(value);
  return static_cast<double>(f) <= value ? f : std::nextafter(f, -std::numeric_limits<float>::infinity());
}
float above(double value) { return -below(-value); }

/// Least and greatest of n . v over the box [lo, hi] of normals.
std::array<double, 2> products(const glm::dvec3& lo, const glm::dvec3& hi, const glm::dvec3& v) {
  std::array<double, 2> range{0.0, 0.0};
  for (int axis = 0; axis < 3; ++axis) {
    range[0] += std::min(lo[axis] * v[axis], hi[axis] * v[axis]);
    range[1] += std::max(lo[axis] * v[axis], hi[axis] * v[axis]);
  }
  return range;
}

}  // namespace

NormalCluster make_cluster(std::span<const FacePlane> planes, const glm::vec3& origin) {
  glm::dvec3 lo(infinity), hi(-infinity);
  double d = infinity, front = -infinity, height = infinity;
  for (const FacePlane& plane : planes) {
    height = std::min(height, plane.height);
    if (!(plane.height > 0.0)) continue;
    lo = glm::min(lo, plane.normal);
    hi = glm::max(hi, plane.normal);
    const double offset = plane.offset - glm::dot(plane.normal, glm::dvec3(origin));
    d = std::min(d, offset);
    front = std::max(front, offset);
  }
  NormalCluster cluster;
  cluster.c = origin;
  cluster.sharpness = std::numeric_limits<float>::infinity();
  if (!(lo.x <= hi.x)) return cluster;
  for (int axis = 0; axis < 3; ++axis) {
    cluster.n[axis] = below(lo[axis]);
    cluster.m[axis] = above(hi[axis]);
  }
  cluster.d = below(d);
  cluster.front = above(front);
  if (height > 0.0) cluster.sharpness = above(1.0 / height);
  return cluster;
}

NormalCluster best_cluster(std::span<const FacePlane> planes, const Aabb& bounds, const Aabb& viewpoints) {
  NormalCluster best = make_cluster(planes, bounds.centre());
  double most = culling_volume(best, viewpoints);
  for (int corner = 0; corner < 8; ++corner) {
    const NormalCluster other = make_cluster(planes, bounds.corner(corner));
    const double volume = culling_volume(other, viewpoints);
    if (volume > most) {
      most = volume;
      best = other;
    }
  }
  return best;
}

NormalCluster merge(const NormalCluster& a, const NormalCluster& b) {
  NormalCluster both = a;
  // n . (p - c_a) = n . (p - c_b) + n . (c_b - c_a), the last term bounded over the box of b's normals (E38).
  const auto [least, greatest] = products(b.n, b.m, glm::dvec3(b.c) - glm::dvec3(a.c));
  both.n = glm::min(a.n, b.n);
  both.m = glm::max(a.m, b.m);
  both.d = std::min(a.d, below(static_cast<double>(b.d) + least));
  both.front = std::max(a.front, above(static_cast<double>(b.front) + greatest));
  both.sharpness = std::max(a.sharpness, b.sharpness);
  return both;
}

double volume_below(const Aabb& box, const glm::dvec3& normal, double d) {
  if (box.empty()) return 0.0;
  // Mirror axes so that the normal is not negative, and start at the corner lo.
  glm::dvec3 size(box.hi), n = normal;
  size -= glm::dvec3(box.lo);
  for (int axis = 0; axis < 3; ++axis) {
    const double from = static_cast<double>(n[axis] >= 0 ? box.lo[axis] : box.hi[axis]);
    d -= n[axis] * from;
    n[axis] = std::abs(n[axis]);
  }
  const double volume = size.x * size.y * size.z;
  if (!(volume > 0.0)) return 0.0;
  // Axes along which the plane hardly changes do not cut.
  std::array<double, 3> edge{};
  int used = 0;
  const double all = n.x * size.x + n.y * size.y + n.z * size.z;
  if (d <= 0.0 && all > 0.0) return 0.0;
  if (all <= 0.0) return d >= 0.0 ? volume : 0.0;
  if (d >= all) return volume;
  double rest = 0.0;
  for (int axis = 0; axis < 3; ++axis)
    if (n[axis] * size[axis] > 1e-5 * all)
      edge[static_cast<std::size_t>(used++)] = n[axis] * size[axis];
    else
      rest += n[axis] * size[axis];
  d -= 0.5 * rest;
  // The share of a unit cube below sum of edge_k x_k = d: simplices by inclusion and exclusion.
  double share = 0.0;
  for (int set = 0; set < (1 << used); ++set) {
    double left = d;
    int bits = 0;
    for (int k = 0; k < used; ++k)
      if (((set >> k) & 1) != 0) {
        left -= edge[static_cast<std::size_t>(k)];
        ++bits;
      }
    if (left > 0.0) share += (bits % 2 == 0 ? 1.0 : -1.0) * std::pow(left, used);
  }
  for (int k = 0; k < used; ++k) share /= (k + 1.0) * edge[static_cast<std::size_t>(k)];
  return volume * std::clamp(share, 0.0, 1.0);
}

double culling_volume(const NormalCluster& cluster, const Aabb& viewpoints) {
  double total = 0.0;
  for (int octant = 0; octant < 8; ++octant) {
    Aabb part = viewpoints;
    glm::vec3 normal;
    for (int axis = 0; axis < 3; ++axis) {
      const bool positive = ((octant >> axis) & 1) != 0;
      if (positive)
        part.lo[axis] = std::max(part.lo[axis], cluster.c[axis]);
      else
        part.hi[axis] = std::min(part.hi[axis], cluster.c[axis]);
      normal[axis] = positive ? cluster.m[axis] : cluster.n[axis];
    }
    total += volume_below(part, normal,
                          static_cast<double>(cluster.d) + glm::dot(glm::dvec3(normal), glm::dvec3(cluster.c)));
  }
  return total;
}

double culling_volume(const NormalCluster& cluster) {
  if (cluster.d < 0.0f) {
    // The eye at c is not inside. The set is a cone around some direction, or empty.
    for (int octant = 0; octant < 8; ++octant)
      for (int axis = 0; axis < 3; ++axis)
        if ((((octant >> axis) & 1) != 0 ? cluster.m[axis] < 0.0f : cluster.n[axis] > 0.0f)) return infinity;
    return 0.0;
  }
  double total = 0.0;
  for (int octant = 0; octant < 8; ++octant) {
    double product = 6.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double slope =
          ((octant >> axis) & 1) != 0 ? static_cast<double>(cluster.m[axis]) : -static_cast<double>(cluster.n[axis]);
      if (slope <= 0.0) return infinity;
      product *= slope;
    }
    total += std::pow(static_cast<double>(cluster.d), 3) / product;
  }
  return total;
}

double culling_probability(const NormalCluster& cluster, const Aabb& viewpoints) {
  const glm::dvec3 size(viewpoints.extent());
  const double all = size.x * size.y * size.z;
  return all > 0.0 ? std::min(1.0, culling_volume(cluster, viewpoints) / all) : 0.0;
}

Aabb near_field(const Aabb& box, float factor) {
  if (box.empty()) return box;
  const glm::vec3 extent = box.extent();
  const float longest = std::max({extent.x, extent.y, extent.z, 1e-30f});
  const glm::vec3 half = 0.5f * factor * glm::max(extent, glm::vec3(0.01f * longest));
  return {box.centre() - half, box.centre() + half};
}

}  // namespace sightline
