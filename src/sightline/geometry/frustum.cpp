#include "sightline/geometry/frustum.hpp"

#include <cmath>

namespace sightline {

Frustum frustum_of(const glm::dmat4& view_projection, double reach) {
  const glm::dmat4 rows = glm::transpose(view_projection);
  const std::array<glm::dvec4, 6> candidates{rows[3] + rows[0], rows[3] - rows[0], rows[3] + rows[1],
                                             rows[3] - rows[1], rows[3] + rows[2], rows[3] - rows[2]};
  Frustum frustum;
  for (const glm::dvec4& row : candidates) {
    const double length = glm::length(glm::dvec3(row));
    if (!(length > 1e-12)) continue;  // infinite far plane: 0 * p + constant
    const glm::dvec4 unit = row / length;
    // Four products and three sums in float, each within half an ulp of a term no larger than |offset| + 2 reach;
    // rounding normal and offset to float adds the same again.
    const double slack = 8.0 * 0x1p-24 * (std::abs(unit.w) + 2.0 * reach);
    frustum.planes[static_cast<std::size_t>(frustum.count++)] = {glm::vec3(unit), static_cast<float>(unit.w + slack)};
  }
  return frustum;
}

}  // namespace sightline
