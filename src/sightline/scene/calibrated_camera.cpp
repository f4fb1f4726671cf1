#include "sightline/scene/calibrated_camera.hpp"

#include <cmath>

#include "sightline/scene/input_error.hpp"

namespace sightline {

void check_camera(const CalibratedCamera& camera) {
  constexpr int most_pixels = 32768;
  const auto require = [](bool holds, const char* reason) {
    if (!holds) throw InputError(reason);
  };
  require(camera.width >= 1 && camera.width <= most_pixels, "width is not in [1, 32768]");
  require(camera.height >= 1 && camera.height <= most_pixels, "height is not in [1, 32768]");
  require(std::isfinite(camera.fx) && camera.fx > 0.0, "fx is not above 0");
  require(std::isfinite(camera.fy) && camera.fy > 0.0, "fy is not above 0");
  require(std::isfinite(camera.cx) && std::isfinite(camera.cy), "the principal point is not finite");
  for (int i = 0; i < 3; ++i) {
    require(std::isfinite(camera.centre[i]) && std::abs(camera.centre[i]) <= largest_distance,
            "the centre is not finite or too far away");
    for (int j = 0; j <= i; ++j)
      require(std::abs(glm::dot(camera.rotation[i], camera.rotation[j]) - (i == j ? 1.0 : 0.0)) <= 1e-3,
              "the rotation is not orthonormal");
  }
  require(glm::determinant(camera.rotation) > 0.0, "the rotation mirrors");
  require(camera.near > 0.0 && std::isfinite(camera.near), "near is not above 0");
  require(camera.far > camera.near, "far is not beyond near");
}

CalibratedCamera calibrated(const View& view) {
  CalibratedCamera camera;
  camera.projection = view.projection;
  camera.width = view.width;
  camera.height = view.height;
  camera.fx = camera.fy = view.projection == Projection::perspective ? 0.5 * view.height / std::tan(0.5 * view.fov_y)
                                                                     : view.height / view.span_y;
  camera.cx = 0.5 * view.width;
  camera.cy = 0.5 * view.height;
  const glm::dmat3 turn = glm::mat3_cast(view.orientation);  // view space to world
  camera.rotation = glm::transpose(glm::dmat3(turn[0], -turn[1], -turn[2]));
  camera.centre = view.eye;
  camera.near = view.near;
  camera.far = view.far;
  return camera;
}

}  // namespace sightline
