// Occluders that reach before the near plane or far out of the image: clipped in double precision, then drawn by the
// same kernels. The cut at the near plane is a contour; cuts outside of the image need none. Internal to raster/.
#pragma once

#include <glm/glm.hpp>

#include "sightline/raster/occlusion_kernels.hpp"

namespace sightline::raster {

/// Mesh space to pixels: rows * p + offset is (x, y, distance), x and y from the image's centre, times the distance for
/// perspective views.
struct ClipTransform {
  glm::dmat3 rows;
  glm::dvec3 offset;
  glm::dvec2 centre;
  double near, guard;
  bool perspective;
};

void draw_clipped(const OccluderMesh& mesh, const ClipTransform& transform, bool mirrored, const Margins& margins,
                  const Kernels& kernels, Tiles& tiles, FillCounts& counts);

}  // namespace sightline::raster
