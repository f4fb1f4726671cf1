// Affine transforms of points and boxes: a 3 x 4 matrix, column vectors, the last column is the translation.
#pragma once

#include <glm/glm.hpp>

namespace sightline {

using Affine = glm::mat4x3;

inline Affine identity_affine() { return Affine(1.0f); }

inline glm::vec3 transform_point(const Affine& m, const glm::vec3& p) {
  return m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
}

/// The affine map as a 4 x 4 matrix in double precision.
inline glm::dmat4 to_matrix(const Affine& m) {
  return {glm::dvec4(m[0], 0.0), glm::dvec4(m[1], 0.0), glm::dvec4(m[2], 0.0), glm::dvec4(m[3], 1.0)};
}

/// Drops the last row, which must be (0, 0, 0, 1); rounds to float.
inline Affine to_affine(const glm::dmat4& m) {
  return {glm::vec3(m[0]), glm::vec3(m[1]), glm::vec3(m[2]), glm::vec3(m[3])};
}

/// Determinant of the linear part: negative means that the map turns front faces into back faces.
inline float determinant(const Affine& m) { return glm::dot(m[0], glm::cross(m[1], m[2])); }

}  // namespace sightline
