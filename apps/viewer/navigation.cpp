#include "viewer/navigation.hpp"

#include <algorithm>
#include <cmath>

namespace sightline::viewer {
namespace {

constexpr double radians_per_pixel = 0.005, steepest = 1.553;  // 89 degrees: straight up has no side
constexpr double seconds_across = 12.0, fast_factor = 5.0, dolly_share = 0.15;
constexpr double margin = 1.03, overview_pitch = 0.75;
constexpr double farthest = 1e-3 * largest_distance;  // from the pivot: the eye stays where scenes may lie

double size_of(const Aabb& box) { return box.empty() ? 1.0 : std::max(1e-3f, glm::length(box.extent())); }

}  // namespace

Navigation::Navigation(const View& start, const Aabb& scene) : lens_(start), scene_(scene) { go_to(start); }

void Navigation::go_to(const View& view) {
  lens_ = view;
  eye_ = view.eye;
  look(view_direction(view));
  const double ahead = scene_.empty() ? 1.0 : glm::length(glm::dvec3(scene_.centre()) - eye_);
  pivot_ = eye_ + std::max(ahead, 10.0 * view.near) * direction();
}

View Navigation::view(int width, int height) const {
  View view = look_along(eye_, direction());
  view.projection = lens_.projection;
  view.fov_y = lens_.fov_y;
  view.span_y = lens_.span_y;
  view.near = lens_.near;
  view.far = lens_.far;
  view.width = std::clamp(width, 1, 16384);
  view.height = std::clamp(height, 1, 16384);
  if (!scene_.empty()) {
    const glm::dvec3 farthest =
        glm::max(glm::abs(glm::dvec3(scene_.lo) - view.eye), glm::abs(glm::dvec3(scene_.hi) - view.eye));
    view.far = std::max(1.001 * glm::length(farthest), 2.0 * view.near);
  }
  return view;
}

void Navigation::fly(const Motion& motion, double seconds) {
  const glm::dvec3 ahead = direction(), side = glm::normalize(glm::cross(ahead, glm::dvec3(0, 1, 0)));
  const auto axis = [](bool more, bool less) { return static_cast<double>(more) - static_cast<double>(less); };
  const glm::dvec3 way = axis(motion.forward, motion.back) * ahead + axis(motion.right, motion.left) * side +
                         axis(motion.up, motion.down) * glm::dvec3(0, 1, 0);
  const double speed = size_of(scene_) / seconds_across * (motion.fast ? fast_factor : 1.0);
  const glm::dvec3 step = speed * seconds * way;
  eye_ += step;
  pivot_ += step;
}

void Navigation::turn(double dx, double dy) {
  const double distance = glm::length(pivot_ - eye_);
  yaw_ -= radians_per_pixel * dx;
  pitch_ = std::clamp(pitch_ - radians_per_pixel * dy, -steepest, steepest);
  pivot_ = eye_ + distance * direction();
}

void Navigation::orbit(double dx, double dy) {
  const double distance = glm::length(pivot_ - eye_);
  look(pivot_ - eye_);
  yaw_ -= radians_per_pixel * dx;
  pitch_ = std::clamp(pitch_ - radians_per_pixel * dy, -steepest, steepest);
  eye_ = pivot_ - distance * direction();
}

void Navigation::dolly(double notches) {
  const glm::dvec3 way = pivot_ - eye_;
  const double distance = std::max(glm::length(way), 1e-12);
  const double least = std::min(1.0, 2.0 * lens_.near / distance), most = std::max(1.0, farthest / distance);
  eye_ = pivot_ - way * std::clamp(std::pow(1.0 - dolly_share, notches), least, most);
  if (lens_.projection == Projection::orthographic)
    lens_.span_y = std::clamp(lens_.span_y * std::pow(1.0 - dolly_share, notches), smallest_distance, largest_distance);
}

void Navigation::frame(const Aabb& box, double aspect) {
  if (box.empty()) return;
  pivot_ = glm::dvec3(box.centre());
  const glm::dvec3 ahead = direction(), side = glm::normalize(glm::cross(ahead, glm::dvec3(0, 1, 0)));
  const glm::dvec3 up = glm::cross(side, ahead);
  const double tan_y = std::tan(0.5 * lens_.fov_y), tan_x = tan_y * aspect;
  double distance = 0.0, half_height = 0.0;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 corner = glm::dvec3(box.corner(i)) - pivot_;
    const double across = std::abs(glm::dot(corner, side)), high = std::abs(glm::dot(corner, up));
    half_height = std::max({half_height, high, across / aspect});
    const double needed = lens_.projection == Projection::perspective ? std::max(across / tan_x, high / tan_y) : 0.0;
    distance = std::max(distance, needed - glm::dot(corner, ahead));
  }
  if (lens_.projection == Projection::orthographic) lens_.span_y = std::max(2.0 * margin * half_height, 1e-6);
  eye_ = pivot_ - (margin * distance + 2.0 * lens_.near) * ahead;
}

void Navigation::overview(const Aabb& box, double aspect) {
  pitch_ = -overview_pitch;
  frame(box, aspect);
}

glm::dvec3 Navigation::direction() const {
  return {-std::sin(yaw_) * std::cos(pitch_), std::sin(pitch_), -std::cos(yaw_) * std::cos(pitch_)};
}

void Navigation::look(const glm::dvec3& direction) {
  const double length = glm::length(direction);
  if (!(length > 0.0)) return;
  const glm::dvec3 d = direction / length;
  pitch_ = std::clamp(std::asin(std::clamp(d.y, -1.0, 1.0)), -steepest, steepest);
  if (std::abs(d.y) < 0.99999) yaw_ = std::atan2(-d.x, -d.z);
}

}  // namespace sightline::viewer
