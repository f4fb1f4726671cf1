// A camera as photogrammetry and robotics know it: intrinsics in pixels and a pose. x right, y down, z forward (OpenCV,
// COLMAP); the centre of the top left pixel lies at (0.5, 0.5), and the principal point is given in that frame.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "sightline/scene/view.hpp"

namespace sightline {

struct CalibratedCamera {
  std::string name;
  Projection projection = Projection::perspective;
  int width = 0, height = 0;      // pixels, 1 to 32768
  double fx = 1.0, fy = 1.0;      // perspective: focal lengths in pixels; orthographic: pixels per metre; > 0
  double cx = 0.0, cy = 0.0;      // principal point, pixels
  glm::dmat3 rotation{1.0};       // world to camera, orthonormal
  glm::dvec3 centre{0.0};         // world, metres
  double near = 1e-3, far = 1e9;  // distances along the camera's z, metres, 0 < near < far

  [[nodiscard]] glm::dvec3 to_camera(const glm::dvec3& world) const { return rotation * (world - centre); }
};

/// Throws InputError with the reason if a field is out of its range.
void check_camera(const CalibratedCamera& camera);

/// The camera whose pixels are those of a view.
CalibratedCamera calibrated(const View& view);

/// Cameras from JSON, {"cameras": [...]}, each with "width", "height" and
/// - "model": "pinhole" (default) with "fx", "fy" (default fx), "cx", "cy" (default: the middle), or "orthographic"
/// with
///   "span_y" (metres that the height shows);
/// - a pose: "eye" with "look" or "target" and optionally "up"; or "qvec" (w, x, y, z) and "tvec" (COLMAP: camera = R
///   world + t); or "rotation" (9 numbers, rows) and "translation"; or "camera_to_world" (16 numbers, rows);
/// - optionally "name", "near", "far".
/// Throws InputError with file, position and reason. (In the target sightline::io.)
std::vector<CalibratedCamera> read_cameras(const std::filesystem::path& file);

}  // namespace sightline
