// Where a camera can be: a grid over a part of the scene whose cells know whether a surface passes through them and how
// high the floor in them is. Promise: a surface that is looked at triangle by triangle leaves no gap in the grid.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "sightline/scene/scene.hpp"

namespace sightline {

struct FreeSpaceConfig {
  std::uint64_t cells = 3'000'000;  // about so many at most
  std::uint64_t triangles =
      20'000'000;            // instanced triangles looked at; beyond, the bounds of the smaller objects count
  double finest = 0.0;       // edge of a cell, metres; the cells get no smaller than this
  double coarsest = 0.0;     // the window shrinks rather than the cells grow beyond this; 0: no limit
  double margin_side = 0.0;  // free space around the scene, metres
  double margin_top = 0.0;
  std::uint64_t seed = 1;  // which part of a large scene
};

class FreeSpace {
 public:
  FreeSpace(const Scene& scene, const FreeSpaceConfig& config);

  [[nodiscard]] double cell() const { return cell_; }
  [[nodiscard]] const glm::dvec3& origin() const { return origin_; }
  [[nodiscard]] const glm::ivec3& size() const { return size_; }
  [[nodiscard]] bool holds(const glm::ivec3& c) const {
    return c.x >= 0 && c.y >= 0 && c.z >= 0 && c.x < size_.x && c.y < size_.y && c.z < size_.z;
  }
  /// The cell of a point; may lie outside of the grid.
  [[nodiscard]] glm::ivec3 cell_of(const glm::dvec3& point) const {
    return glm::ivec3(glm::clamp(glm::floor((point - origin_) / cell_), -1e9, 1e9));
  }
  [[nodiscard]] glm::dvec3 centre_of(const glm::ivec3& c) const { return origin_ + (glm::dvec3(c) + 0.5) * cell_; }
  /// True iff the cell lies in the grid and no surface passes through it.
  [[nodiscard]] bool free(const glm::ivec3& c) const { return holds(c) && !surface_[index(c)]; }
  [[nodiscard]] bool free(const glm::dvec3& point) const { return free(cell_of(point)); }
  /// The highest up-facing surface in a cell of the grid; -infinity if there is none.
  [[nodiscard]] float floor(const glm::ivec3& c) const { return floor_[index(c)]; }

 private:
  [[nodiscard]] std::size_t index(const glm::ivec3& c) const {
    const glm::uvec3 u(c), n(size_);
    return (std::size_t{u.y} * n.z + u.z) * n.x + u.x;
  }
  void choose_window(const Scene& scene, const FreeSpaceConfig& config);
  void add_objects(const Scene& scene, const FreeSpaceConfig& config);
  void add_box(const Aabb& box);
  void add_triangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, bool faces_up);

  glm::dvec3 origin_{0.0};
  glm::ivec3 size_{0};
  double cell_ = 1.0;
  std::vector<char> surface_;
  std::vector<float> floor_;
};

/// True iff the point lies inside of a closed object: the ray along +y crosses its surface an odd number of times.
bool inside_closed_object(const Scene& scene, const glm::dvec3& point);

}  // namespace sightline
