// Turns a way from cell to cell into a curve that stays in free space.
#pragma once

#include "sightline/scene/path/free_space.hpp"

namespace sightline {

/// Equally spaced points along a way, relaxed towards a smooth curve; no point or middle between two leaves the free
/// cells unless it was outside of them before.
std::vector<glm::dvec3> smooth_way(const FreeSpace& space, const std::vector<glm::dvec3>& way, int rounds);

/// A polyline by length.
class Trail {
 public:
  explicit Trail(std::vector<glm::dvec3> points);
  [[nodiscard]] double length() const { return lengths_.back(); }
  /// The point that many metres from the start; clamped to the ends.
  [[nodiscard]] glm::dvec3 at(double distance) const;

 private:
  std::vector<glm::dvec3> points_;
  std::vector<double> lengths_;
};

}  // namespace sightline
