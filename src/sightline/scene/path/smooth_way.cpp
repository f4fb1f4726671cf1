#include "sightline/scene/path/smooth_way.hpp"

#include <algorithm>
#include <cmath>

namespace sightline {

std::vector<glm::dvec3> smooth_way(const FreeSpace& space, const std::vector<glm::dvec3>& way, int rounds) {
  const Trail trail(way);
  const auto pieces = static_cast<std::size_t>(std::ceil(trail.length() / (0.6 * space.cell())));
  if (pieces < 3) return way;
  std::vector<glm::dvec3> points;
  for (std::size_t i = 0; i <= pieces; ++i)
    points.push_back(trail.at(trail.length() * static_cast<double>(i) / static_cast<double>(pieces)));
  for (int round = 0; round < rounds; ++round)
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
      const glm::dvec3 moved = 0.25 * (points[i - 1] + 2.0 * points[i] + points[i + 1]);
      if (space.free(moved) && space.free(0.5 * (moved + points[i - 1])) && space.free(0.5 * (moved + points[i + 1])))
        points[i] = moved;
    }
  return points;
}

Trail::Trail(std::vector<glm::dvec3> points) : points_(std::move(points)) {
  lengths_.push_back(0.0);
  for (std::size_t i = 1; i < points_.size(); ++i)
    lengths_.push_back(lengths_.back() + glm::length(points_[i] - points_[i - 1]));
}

glm::dvec3 Trail::at(double distance) const {
  const auto after = std::upper_bound(lengths_.begin(), lengths_.end(), distance);
  if (after == lengths_.begin()) return points_.front();
  if (after == lengths_.end()) return points_.back();
  const auto i = static_cast<std::size_t>(after - lengths_.begin());
  const double t = (distance - lengths_[i - 1]) / (lengths_[i] - lengths_[i - 1]);
  return points_[i - 1] + (points_[i] - points_[i - 1]) * t;
}

}  // namespace sightline
