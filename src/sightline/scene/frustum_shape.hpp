// The view frustum as a solid: its corners (checklist 20.08) and the volumes that enclose it (meta-bounds, 20.15).
#pragma once

#include <array>

#include "sightline/geometry/sphere.hpp"
#include "sightline/scene/view.hpp"

namespace sightline {

/// F = C + f d, P = F +- H/2 v +- W/2 u: 0..3 on the near plane, 4..7 on the far plane; bit 0 right, bit 1 up. World
/// space. An infinite far plane is taken at `reach` metres, which must be beyond the scene.
std::array<glm::dvec3, 8> frustum_corners(const View& view, double reach);

/// A sphere and a box that hold the frustum; rounded outwards.
Sphere frustum_sphere(const View& view, double reach);
Aabb frustum_box(const View& view, double reach);

}  // namespace sightline
