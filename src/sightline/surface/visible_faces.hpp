// Which faces (triangles) of a scene each of many cameras sees: an id raster per camera (checklist 3.01, 8.01), and for
// faces that no pixel centre falls on, further points in an irregular z-buffer (Johnson et al. 2005). Promise: a face
// reported is seen (through its pixel centre or point); one not reported is hidden at all pixel centres and at all its
// points, so only a face seen through gaps between those is lost.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sightline/scene/calibrated_camera.hpp"
#include "sightline/scene/scene.hpp"

namespace sightline {

struct VisibleFacesConfig {
  /// Points for a face without a pixel centre: 0 none, 1 the middle of what the image shows of it, 4 also three between
  /// the middle and its corners.
  int extra_points = 4;
};

/// What one camera sees. Faces are numbered by object, then triangle.
struct CameraFaces {
  std::span<const std::uint32_t> samples;  // pixel centres through which each face is seen
  std::span<const std::uint8_t> seen;      // 1 if samples > 0 or a further point saw it
};

/// Calls done(camera index, result) once for each camera, possibly at once from several threads and in any order; it
/// must not throw. Surfaces in front that are not opaque hide nothing. Faces of equal depth: the lowest is seen.
/// Throws InputError for a camera out of range, or more than 2^32 - 2 faces. The same for any number of threads.
void visible_faces(const Scene& scene, std::span<const CalibratedCamera> cameras, const VisibleFacesConfig& config,
                   const std::function<void(std::size_t, const CameraFaces&)>& done);

/// The number of the first face of every object, and at the end the number of faces.
std::vector<std::uint64_t> first_faces(const Scene& scene);

}  // namespace sightline
