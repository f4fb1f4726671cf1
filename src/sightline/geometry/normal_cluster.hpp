// Triangles that turn their backs, or their faces, as one: bounds of their normals and plane offsets, tested by the
// octant of the eye (Johannsen and Carter 1998, checklist 19.01-19.15 with E35, E37-E39, E52). Conservative.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "sightline/geometry/aabb.hpp"
#include "sightline/geometry/face_planes.hpp"

namespace sightline {

/// 48 bytes: the 28 of the back test, 4 for the front test (E37), 12 for the local origin (19.08), 4 for rounding.
struct NormalCluster {
  glm::vec3 n{0.0f}, m{0.0f};  // componentwise least and greatest of the unit normals (19.04)
  float d = 0.0f;              // min of n_i . (p_i - c): back test
  float front = 0.0f;          // max of n_i . (p_i - c): front test
  glm::vec3 c{0.0f};           // local origin
  float sharpness = 0.0f;      // 1 / least height of the triangles
};

/// if(e; u, v) of 19.05: per component u where e >= 0, else v.
inline glm::vec3 octant_select(const glm::vec3& e, const glm::vec3& u, const glm::vec3& v) {
  return {e.x >= 0 ? u.x : v.x, e.y >= 0 ? u.y : v.y, e.z >= 0 ? u.z : v.z};
}

/// All triangles turn their backs for sure: if(e-c; m, n) . (e-c) - d <= -slack (19.05, 19.08). `eye` has w = 1, or w =
/// 0 for the direction towards the eye of an orthographic view.
inline bool turns_back(const NormalCluster& cluster, const glm::vec4& eye, float slack) {
  const glm::vec3 v = glm::vec3(eye) - cluster.c * eye.w;
  return glm::dot(octant_select(v, cluster.m, cluster.n), v) - cluster.d * eye.w <= -slack;
}
/// All triangles face the eye: if(e-c; n, m) . (e-c) - front > 0 (19.11).
inline bool turns_front(const NormalCluster& cluster, const glm::vec4& eye) {
  const glm::vec3 v = glm::vec3(eye) - cluster.c * eye.w;
  return glm::dot(octant_select(v, cluster.n, cluster.m), v) - cluster.front * eye.w > 0.0f;
}

/// The cluster of some planes with local origin `origin`; all bounds rounded outwards. Planes without area make it
/// infinitely sharp: never culled.
NormalCluster make_cluster(std::span<const FacePlane> planes, const glm::vec3& origin);

/// Of the centre and the corners of `bounds` the origin for which the cluster is culled most probably from a viewpoint
/// in `viewpoints` (19.08, 19.12).
NormalCluster best_cluster(std::span<const FacePlane> planes, const Aabb& bounds, const Aabb& viewpoints);

/// Bounds both (19.10, E38): b is brought to the local origin of a first. Looser than the cluster of all planes.
NormalCluster merge(const NormalCluster& a, const NormalCluster& b);

/// Volume of {e in box : n . e <= d}, exact up to double rounding.
double volume_below(const Aabb& box, const glm::dvec3& n, double d);

/// Exact volume of the culling volume {e : turns_back(e)} within `viewpoints` (19.07, 19.12, E52): eight octants around
/// c, in each a box cut by one plane.
double culling_volume(const NormalCluster& cluster, const Aabb& viewpoints);
/// The whole culling volume, which is bounded iff every component of n is negative and of m positive and d > 0: eight
/// tetrahedra that meet at (d / m_x, 0, 0) and so on (19.07); infinity or 0 otherwise.
double culling_volume(const NormalCluster& cluster);
/// Vol(C) / Vol(U) for viewpoints spread evenly in U (19.12).
double culling_probability(const NormalCluster& cluster, const Aabb& viewpoints);
/// U = `factor` * box about its centre, the "near field" (19.13, E52); flat sides count as a hundredth of the longest.
Aabb near_field(const Aabb& box, float factor);

/// T(A) = t_C + (1 - P(A)) n_A r (19.14), in units of r.
struct ClusterCost {
  double test = 1.0;  // t_C / r: a cluster test against the work for one triangle that is not culled
  [[nodiscard]] double of(double probability, double triangles) const { return test + (1.0 - probability) * triangles; }
  /// P(C) above which one cluster is cheaper than two; the sign of t_C is E39's.
  [[nodiscard]] double merge_threshold(double p_a, double n_a, double p_b, double n_b) const {
    return (p_a * n_a + p_b * n_b - test) / (n_a + n_b);
  }
};

}  // namespace sightline
