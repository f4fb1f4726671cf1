// The occlusion horizon of a 2.5-D city (Wonka and Schmalstieg 1999; Downs, Moller, Sequin 2001; checklist 21.03), made
// safe for any scene: over columns of plan directions, from which to which slope everything is hidden by walls drawn so
// far. Columns do not tilt with the camera. Front to back: ask about all that lies nearer before a wall is added.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/raster/wall_fences.hpp"
#include "sightline/scene/view.hpp"

namespace sightline {

/// A box as the horizon sees it.
struct HorizonBox {
  double nearest, farthest;  // along the view's plan direction, metres
  double u0, u1, v0, v1;     // columns' coordinate, slope
  bool askable;              // wholly before the eye's plan line, so that the other fields mean something
};

/// What hiding a box takes: that the columns first to last hide the slopes low to high. first > last: nothing hides it.
struct HorizonQuery {
  std::uint16_t first = 1, last = 0;
  float low = 0, high = 0;
};

class Horizon {
 public:
  /// Starts a view with nothing hidden; at most `columns` columns (up to 65535) over what the view can see. False if
  /// the view looks so steeply that it has no horizon; then nothing may be added or asked.
  bool begin(const View& view, int columns);

  [[nodiscard]] HorizonBox project(const Aabb& box) const;
  [[nodiscard]] HorizonQuery query(const HorizonBox& box) const;
  /// True if the box of the query is hidden by fences added so far, all of which must lie nearer than its nearest
  /// point.
  [[nodiscard]] bool hides(const HorizonQuery& query, std::uint64_t& cells) const;

  /// Adds a fence moved by `offset`. Rectangles that reach before the near plane or behind the eye are left out.
  /// `slack`: metres by which the real walls may differ.
  void add(const WallFence& fence, const glm::dvec3& offset, double slack);

  [[nodiscard]] int columns() const { return columns_; }
  /// The hidden interval of slopes of a column; empty (low > high) where nothing is hidden. Slope: height over the eye
  /// per metre of plan distance; for orthographic views height over the ray through the eye.
  [[nodiscard]] float low(int column) const { return low_[static_cast<std::size_t>(column)]; }
  [[nodiscard]] float high(int column) const { return high_[static_cast<std::size_t>(column)]; }
  /// The coordinate of the left border of a column.
  [[nodiscard]] double border(int column) const { return -limit_ + column / per_u_; }

 private:
  struct Point {
    double u, z;       // z: what is affine in u along a straight wall, 1 / distance or, orthographic, the distance
    bool behind_near;  // all of the upright edge lies behind the near plane
  };
  [[nodiscard]] Point point(const glm::dvec2& plan, double y0, double y1) const;
  [[nodiscard]] double slope(double y, double z) const {
    return perspective_ ? (y - eye_.y) * z : y - eye_.y - tilt_ * z;
  }
  void add_run(std::span<const Point> run, double y0, double y1, double slack);
  void merge(int column, double low, double high);

  glm::dvec3 eye_{0.0}, direction_{0.0};
  glm::dvec2 forward_{0.0}, right_{0.0};
  double tilt_ = 0, near_ = 0, limit_ = 1, per_u_ = 1, reach_ = 0;
  bool perspective_ = true, open_sides_ = false;
  int columns_ = 0;
  std::vector<float> low_, high_;  // by column, padded
  std::vector<Point> points_;
};

}  // namespace sightline
