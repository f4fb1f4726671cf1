#include "sightline/raster/scene_rays.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "sightline/scene/input_error.hpp"

namespace sightline {
namespace {

/// Distances at which the ray enters and leaves the box, a little widened for rounding.
bool meets_box(const Aabb& box, const SceneRay& ray, const glm::dvec3& inverse, double t_max, double& t_entry) {
  double t0 = ray.t_min, t1 = t_max;
  for (int axis = 0; axis < 3; ++axis) {
    if (ray.direction[axis] == 0.0) {
      if (ray.origin[axis] < static_cast<double>(box.lo[axis]) || ray.origin[axis] > static_cast<double>(box.hi[axis]))
        return false;
      continue;
    }
    double a = (static_cast<double>(box.lo[axis]) - ray.origin[axis]) * inverse[axis];
    double b = (static_cast<double>(box.hi[axis]) - ray.origin[axis]) * inverse[axis];
    if (a > b) std::swap(a, b);
    t0 = std::max(t0, a - 1e-14 * std::abs(a));
    t1 = std::min(t1, b + 1e-14 * std::abs(b));
  }
  t_entry = t0;
  return t0 <= t1;
}

/// Signed volumes of the ray and the edges (Plucker coordinates): for a shared edge exactly negated, so none slips
/// through between two triangles.
bool meets_triangle(const SceneRay& ray, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, double& t) {
  const double u = glm::dot(ray.direction, glm::cross(b, c));
  const double v = glm::dot(ray.direction, glm::cross(c, a));
  const double w = glm::dot(ray.direction, glm::cross(a, b));
  if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) return false;
  const double sum = u + v + w;
  if (sum == 0.0) return false;  // parallel to the triangle, or the triangle has no area
  const glm::dvec3 normal = glm::cross(b - a, c - a);
  const double slope = glm::dot(normal, ray.direction);
  if (slope == 0.0) return false;
  t = glm::dot(normal, a) / slope;
  return std::isfinite(t);
}

}  // namespace

SceneRays::SceneRays(const Scene& scene, std::uint64_t most_triangles) : scene_(scene) {
  if (scene.triangle_count() > most_triangles)
    throw InputError("the scene has " + std::to_string(scene.triangle_count()) + " triangles, more than " +
                     std::to_string(most_triangles));
  std::vector<Face> faces;
  std::vector<Aabb> boxes;
  faces.reserve(scene.triangle_count());
  boxes.reserve(scene.triangle_count());
  for (ObjectId id = 0; id < scene.objects().size(); ++id) {
    const Object& object = scene.objects()[id];
    const Mesh& mesh = scene.meshes()[object.mesh];
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const glm::uvec3& v = mesh.triangles[t];
      faces.push_back({transform_point(object.transform, mesh.positions[v.x]),
                       transform_point(object.transform, mesh.positions[v.y]),
                       transform_point(object.transform, mesh.positions[v.z]), id, t});
      Aabb box;
      box.extend(faces.back().a);
      box.extend(faces.back().b);
      box.extend(faces.back().c);
      boxes.push_back(box);
    }
  }
  Bvh bvh = build_bvh(boxes);
  nodes_ = std::move(bvh.nodes);
  faces_.reserve(faces.size());
  for (const std::uint32_t item : bvh.items) faces_.push_back(faces[item]);
}

bool SceneRays::nearest(const SceneRay& ray, SceneRayHit& hit, Blockers blockers, const VisibleSet* only) const {
  const double size = std::max({std::abs(ray.direction.x), std::abs(ray.direction.y), std::abs(ray.direction.z)});
  if (!(size > 0.0) || !std::isfinite(size) || !std::isfinite(ray.origin.x + ray.origin.y + ray.origin.z) ||
      !(ray.t_min <= ray.t_max))
    return false;
  const glm::dvec3 inverse = 1.0 / ray.direction;
  double best = ray.t_max;
  hit = {};
  struct Entry {
    std::uint32_t node;
    double t;
  };
  Entry stack[1024];  // deeper than any tree over floats that parts boxes by position
  std::size_t top = 0;
  double entry = 0.0;
  if (!nodes_.empty() && meets_box(nodes_[0].bounds, ray, inverse, best, entry)) stack[top++] = {0, entry};
  while (top > 0) {
    const Entry current = stack[--top];
    if (current.t > best) continue;
    const BvhNode& node = nodes_[current.node];
    if (!node.leaf()) {
      double t0 = 0.0, t1 = 0.0;
      const bool meets0 = meets_box(nodes_[node.first].bounds, ray, inverse, best, t0);
      const bool meets1 = meets_box(nodes_[node.first + 1].bounds, ray, inverse, best, t1);
      const bool second_nearer = meets0 && meets1 && t1 < t0;
      if (meets1 && !second_nearer) stack[top++] = {node.first + 1, t1};
      if (meets0) stack[top++] = {node.first, t0};
      if (meets1 && second_nearer) stack[top++] = {node.first + 1, t1};
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const Face& face = faces_[i];
      double t = 0.0;
      if (!meets_triangle(ray, glm::dvec3(face.a) - ray.origin, glm::dvec3(face.b) - ray.origin,
                          glm::dvec3(face.c) - ray.origin, t))
        continue;
      if (t < ray.t_min || t > best) continue;
      if (blockers == Blockers::opaque && !scene_.objects()[face.object].opaque) continue;
      if (only != nullptr && !only->contains(face.object)) continue;
      const bool lower = face.object < hit.object || (face.object == hit.object && face.triangle < hit.triangle);
      if (hit.object != no_object && t == best && !lower) continue;
      best = t;
      hit = {t, face.object, face.triangle};
    }
  }
  return hit.object != no_object;
}

void SceneRays::corners(ObjectId object, std::uint32_t triangle, glm::dvec3 (&result)[3]) const {
  const Object& o = scene_.objects()[object];
  const Mesh& mesh = scene_.meshes()[o.mesh];
  for (int k = 0; k < 3; ++k)
    result[k] = glm::dvec3(transform_point(o.transform, mesh.positions[mesh.triangles[triangle][k]]));
}

}  // namespace sightline
