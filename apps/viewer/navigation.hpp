// How a person moves through a scene: orbiting a point, flying with W A S D, as a plain value that knows no window.
#pragma once

#include "sightline/scene/view.hpp"

namespace sightline::viewer {

/// Keys held down, for flying.
struct Motion {
  bool forward = false, back = false, left = false, right = false, up = false, down = false, fast = false;
};

/// Angles in radians, lengths in metres, world space.
class Navigation {
 public:
  /// Starts at `start`; its projection, fov and near plane are kept. `scene`: bounds that F frames and speeds follow.
  Navigation(const View& start, const Aabb& scene);

  /// The camera for a viewport of width x height pixels. The far plane holds the whole scene.
  [[nodiscard]] View view(int width, int height) const;
  /// Goes to another camera, e.g. one of a path.
  void go_to(const View& view);
  /// Moves for so many seconds.
  void fly(const Motion& motion, double seconds);
  /// Turns the head: a drag by so many pixels.
  void turn(double dx, double dy);
  /// Circles around the pivot, the point that was framed or clicked last.
  void orbit(double dx, double dy);
  /// Towards (> 0) or away from the pivot, in notches of a wheel.
  void dolly(double notches);
  /// Makes all of the box visible without turning, on a picture of this width over height; it becomes the pivot.
  void frame(const Aabb& box, double aspect);
  /// The same looking down from above.
  void overview(const Aabb& box, double aspect);
  void set_pivot(const glm::dvec3& point) { pivot_ = point; }
  [[nodiscard]] const glm::dvec3& pivot() const { return pivot_; }

 private:
  [[nodiscard]] glm::dvec3 direction() const;
  void look(const glm::dvec3& direction);

  View lens_;
  Aabb scene_;
  glm::dvec3 eye_{0.0}, pivot_{0.0};
  double yaw_ = 0.0, pitch_ = 0.0;  // yaw 0 looks along -z; pitch > 0 looks up
};

}  // namespace sightline::viewer
