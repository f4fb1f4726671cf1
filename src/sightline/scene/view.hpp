// A camera as a plain value. View space looks along -z, Y up. Pixel (0, 0) is the top left one; the centre of pixel
// (x, y) lies at (x + 0.5, y + 0.5). All matrices are OpenGL's: column vectors, clip space -w <= x, y, z <= w.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <string>

#include "sightline/geometry/frustum.hpp"
#include "sightline/scene/scene.hpp"

namespace sightline {

enum class Projection { perspective, orthographic };

struct View {
  glm::dvec3 eye{0.0};                         // world space, metres; best a float, as the oracle's rays start at one
  glm::dquat orientation{1.0, 0.0, 0.0, 0.0};  // unit; turns view space into world space
  Projection projection = Projection::perspective;
  double fov_y = 1.0471975511965976;  // perspective: full vertical angle, radians, 0.006 to 179.994 degrees
  double span_y = 10.0;               // orthographic: height of the image in metres, smallest_distance or more
  double near = 0.1;                  // distance of the near plane, metres, smallest_distance or more
  double far = 1000.0;                // distance of the far plane, metres, > near; may be infinite for perspective
  int width = 1280, height = 720;     // viewport in pixels, 1 to 16384
};

/// Throws InputError with the reason if a field is not finite or out of its range, or a distance below
/// smallest_distance or above largest_distance.
void check_view(const View& view);

/// View at `eye`, rounded to float as all geometry is, that looks along `direction` (any length > 0); `up` need not be
/// perpendicular. Other fields stay default.
View look_along(const glm::dvec3& eye, const glm::dvec3& direction, const glm::dvec3& up = {0.0, 1.0, 0.0});

glm::dvec3 view_direction(const View& view);
glm::dmat4 view_matrix(const View& view);
glm::dmat4 projection_matrix(const View& view);
glm::dmat4 view_projection(const View& view);

/// The six (or, without a far plane, five) planes with slack for world coordinates up to `reach` metres.
Frustum view_frustum(const View& view, double reach);

/// A box around all of the view's frustum, rounded outwards; infinite where the frustum is. A box that misses it is
/// outside, though each of the planes alone may let it pass (checklist 20.11, E40).
Aabb frustum_bounds(const View& view);

/// The ray through a point of the image: origin + t * direction for t in [t_near, t_far] runs from the near to the far
/// plane. direction has unit depth (its component along the view direction is 1), so t is the distance along -z.
struct PixelRay {
  glm::dvec3 origin, direction;
  double t_near, t_far;
};

/// x, y in pixels from the top left corner of the image; (0.5, 0.5) is the centre of the first pixel.
PixelRay pixel_ray(const View& view, double x, double y);

/// The view as command line options: "--eye x,y,z --look x,y,z --fov degrees --size WxH --near n --far f".
std::string describe(const View& view);

}  // namespace sightline
