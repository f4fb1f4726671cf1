#include "sightline/scene/mesh_eye.hpp"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

double norm(const glm::dmat3& m) {
  return std::sqrt(glm::dot(m[0], m[0]) + glm::dot(m[1], m[1]) + glm::dot(m[2], m[2]));
}

/// At least the greatest stretch of a vector: of two bounds the lesser; 1 for the identity, where `norm` gives 1.73.
double stretch(const glm::dmat3& m) {
  const auto columns = [](const glm::dmat3& a) {
    const auto sum = [](const glm::dvec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); };
    return std::max({sum(a[0]), sum(a[1]), sum(a[2])});
  };
  return std::min(norm(m), std::sqrt(columns(m) * columns(glm::transpose(m))));
}

/// How far a float corner of transform_point lies from the exact one, world units. The identity rounds nothing, an
/// object that is only moved one sum, any other a product and three sums.
double corner_error(const Affine& m, const Mesh& mesh) {
  if (m == identity_affine()) return 0.0;
  Affine linear = m;
  linear[3] = glm::vec3(0.0f);
  const glm::dvec3 size(glm::max(glm::abs(mesh.bounds.lo), glm::abs(mesh.bounds.hi)));
  const glm::dvec3 terms = glm::abs(glm::dvec3(m[0])) * size.x + glm::abs(glm::dvec3(m[1])) * size.y +
                           glm::abs(glm::dvec3(m[2])) * size.z + glm::abs(glm::dvec3(m[3]));
  return (linear == identity_affine() ? 1.0 : 4.0) * 0x1p-24 * glm::length(terms);
}

}  // namespace

bool inverse_linear(const Affine& transform, glm::dmat3& inverse) {
  const glm::dmat3 linear{glm::dvec3(transform[0]), glm::dvec3(transform[1]), glm::dvec3(transform[2])};
  const double size = norm(linear), volume = glm::determinant(linear);
  if (!(std::abs(volume) > 1e-9 * size * size * size)) return false;
  inverse = glm::inverse(linear);
  return true;
}

MeshEye mesh_eye(const View& view, const Object& object, const Mesh& mesh) {
  MeshEye result;
  glm::dmat3 inverse;
  if (mesh.bounds.empty() || !inverse_linear(object.transform, inverse)) return result;
  const glm::dvec3 centre(mesh.bounds.centre());
  const double radius = 0.5 * glm::length(glm::dvec3(mesh.bounds.extent())) + 0x1p-22 * glm::length(centre);
  // Corners move by `moved` (mesh space). The volume that eye and triangle span then changes by less than 4 moved D L,
  // D the distance of the farthest corner and L the longest side, unless it is so thin that nothing is culled anyhow;
  // the volume is n . v h L. The same for a direction gives 5 moved L.
  const double moved = stretch(inverse) * corner_error(object.transform, mesh);
  const double crooked =
      norm(inverse) * norm(glm::dmat3(glm::dvec3(object.transform[0]), glm::dvec3(object.transform[1]),
                                      glm::dvec3(object.transform[2])));
  if (view.projection == Projection::orthographic) {
    const glm::dvec3 towards = glm::normalize(inverse * -view_direction(view));
    result.eye = glm::vec4(glm::vec3(towards), 0.0f);
    result.slack = static_cast<float>(0x1p-20 + 1e-14 * crooked);
    result.sharpness = static_cast<float>(5.0 * moved);
  } else {
    const glm::dvec3 world(object.transform[3]);
    const glm::dvec3 eye = inverse * (view.eye - world) - centre;
    const double far = std::abs(eye.x) + std::abs(eye.y) + std::abs(eye.z);
    const double doubles = 1e-14 * (crooked * (far + radius) + glm::length(centre) +
                                    norm(inverse) * (glm::length(view.eye) + glm::length(world)));
    result.eye = glm::vec4(glm::vec3(eye), 1.0f);
    result.slack = static_cast<float>(0x1p-20 * (far + 2.0 * radius) + 6.0 * moved + doubles);
    result.sharpness = static_cast<float>(4.0 * moved * (glm::length(eye) + radius));
  }
  result.valid = std::isfinite(result.eye.x) && std::isfinite(result.eye.y) && std::isfinite(result.eye.z) &&
                 std::isfinite(result.slack) && std::isfinite(result.sharpness);
  return result;
}

}  // namespace sightline
