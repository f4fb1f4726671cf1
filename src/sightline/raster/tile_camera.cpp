#include "sightline/raster/tile_camera.hpp"

namespace sightline::raster {

// Not in the header: the low half of the eye is nothing where a compiler drops the rounding of the high one, which the
// library's own options prevent (cmake/targets.cmake).
MeshTransform TileCamera::mesh_transform(const Affine& to_world) const {
  MeshTransform t{};
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 3; ++row) t.to_world[3 * column + row] = to_world[column][row];
  for (int k = 0; k < 3; ++k) {
    t.eye_high[k] = static_cast<float>(eye[k]);
    t.eye_low[k] = static_cast<float>(eye[k] - static_cast<double>(t.eye_high[k]));
    t.to_x[k] = static_cast<float>(rows[0][k]);
    t.to_y[k] = static_cast<float>(rows[1][k]);
    t.to_w[k] = static_cast<float>(rows[2][k]);
  }
  t.centre_x = static_cast<float>(centre_x);
  t.centre_y = static_cast<float>(centre_y);
  t.near = static_cast<float>(near);
  t.far = static_cast<float>(far);
  t.guard = static_cast<float>(guard);
  t.perspective = perspective;
  return t;
}

}  // namespace sightline::raster
