#include "sightline/geometry/frustum.hpp"

#include <cmath>

namespace sightline {

Frustum frustum_of(const glm::dmat4& view_projection, double reach) {
  const glm::dmat4 rows = glm::transpose(view_projection);
  constexpr double float_ulp = 0x1p-24, double_ulp = 0x1p-53;
  Frustum frustum;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) {
      const glm::dvec4 row = rows[3] + sign * rows[axis];
      const double length = glm::length(glm::dvec3(row));
      // What is left of two rows that cancel (a far plane a billion times as far as the near plane, or infinite) is
      // noise: the plane is left out, which is safe.
      const double size = glm::length(glm::dvec3(rows[3])) + glm::length(glm::dvec3(rows[axis]));
      if (!(length > 1e-9 * size)) continue;
      const glm::dvec4 unit = row / length;
      const double reach_along = std::abs(unit.w) + 2.0 * reach;
      // Four products and three sums in float, each within half an ulp of a term no larger than |offset| + 2 reach;
      // rounding normal and offset to float adds the same again. And the noise of the matrix in double.
      const double noise =
          16.0 * double_ulp * (size * 2.0 * reach + std::abs(rows[3].w) + std::abs(rows[axis].w)) / length;
      const double slack = 8.0 * float_ulp * reach_along + noise;
      frustum.planes[static_cast<std::size_t>(frustum.count++)] = {glm::vec3(unit), static_cast<float>(unit.w + slack)};
    }
  return frustum;
}

}  // namespace sightline
