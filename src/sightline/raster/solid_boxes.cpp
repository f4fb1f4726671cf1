#include "sightline/raster/solid_boxes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace sightline {
namespace {

constexpr std::uint8_t unknown = 0, touched = 1, outside = 2, inside = 3, hollow = 4;

class Voxels {
 public:
  Voxels(const Mesh& mesh, int cells) : mesh_(mesh), n_(cells + 2), lo_(mesh.bounds.lo) {
    const glm::dvec3 extent(mesh.bounds.extent());
    step_ = extent / static_cast<double>(cells);
    lo_ -= step_;  // a layer of cells around the mesh, where the outside begins
    state_.assign(static_cast<std::size_t>(n_) * static_cast<std::size_t>(n_) * static_cast<std::size_t>(n_), unknown);
  }

  void classify() {
    for (const glm::uvec3& t : mesh_.triangles)
      touch(glm::dvec3(mesh_.positions[t.x]), glm::dvec3(mesh_.positions[t.y]), glm::dvec3(mesh_.positions[t.z]));
    fill({0, 0, 0}, outside);
    for (int z = 0; z < n_; ++z)
      for (int y = 0; y < n_; ++y)
        for (int x = 0; x < n_; ++x)
          if (at(x, y, z) == unknown) fill({x, y, z}, winding_number(mesh_, centre(x, y, z)) != 0 ? inside : hollow);
    sum();
  }

  /// The box that is best by area of the surface it would add; empty cells [lo, hi) if there is none.
  struct CellBox {
    glm::ivec3 lo{0}, hi{0};
    double area = 0;
  };

  [[nodiscard]] CellBox largest(const std::vector<std::uint8_t>& taken) const {
    CellBox best;
    for (int z = 1; z + 1 < n_; ++z)
      for (int y = 1; y + 1 < n_; ++y)
        for (int x = 1; x + 1 < n_; ++x) {
          if (at(x, y, z) != inside || taken[index(x, y, z)] != 0) continue;
          // Every second cell each way, as neighbours grow to the same box; all of them as long as there is none.
          if (best.area > 0 && (x % 2 != 0 || y % 2 != 0 || z % 2 != 0)) continue;
          const CellBox box = grow({x, y, z});
          if (box.area > best.area) best = box;
        }
    return best;
  }

  void take(const CellBox& box, std::vector<std::uint8_t>& taken) const {
    for (int z = box.lo.z; z < box.hi.z; ++z)
      for (int y = box.lo.y; y < box.hi.y; ++y)
        for (int x = box.lo.x; x < box.hi.x; ++x) taken[index(x, y, z)] = 1;
  }

  [[nodiscard]] Aabb box_of(const CellBox& box) const {
    // A little inwards, so that rounding to float stays within the cells.
    const glm::dvec3 inset = 1e-3 * step_;
    return {glm::vec3(lo_ + glm::dvec3(box.lo) * step_ + inset), glm::vec3(lo_ + glm::dvec3(box.hi) * step_ - inset)};
  }
  [[nodiscard]] std::size_t cell_count() const { return state_.size(); }

 private:
  [[nodiscard]] std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(n_) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(n_) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] std::uint8_t at(int x, int y, int z) const { return state_[index(x, y, z)]; }
  [[nodiscard]] glm::dvec3 centre(int x, int y, int z) const { return lo_ + (glm::dvec3(x, y, z) + 0.5) * step_; }

  /// Marks every cell that the triangle may touch: bounds, then the plane against the cell's extent.
  void touch(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const glm::dvec3 slack = 1e-3 * step_;
    const glm::dvec3 lo = (glm::min(glm::min(a, b), c) - slack - lo_) / step_;
    const glm::dvec3 hi = (glm::max(glm::max(a, b), c) + slack - lo_) / step_;
    const auto clamped = [&](double v) { return std::clamp(static_cast<int>(std::floor(v)), 0, n_ - 1); };
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double radius = glm::dot(glm::abs(normal), 0.5 * step_ + slack);
    for (int z = clamped(lo.z); z <= clamped(hi.z); ++z)
      for (int y = clamped(lo.y); y <= clamped(hi.y); ++y)
        for (int x = clamped(lo.x); x <= clamped(hi.x); ++x)
          if (std::abs(glm::dot(normal, centre(x, y, z) - a)) <= radius * (1 + 1e-9)) state_[index(x, y, z)] = touched;
  }

  void fill(const glm::ivec3& start, std::uint8_t value) {
    std::vector<glm::ivec3> stack{start};
    state_[index(start.x, start.y, start.z)] = value;
    while (!stack.empty()) {
      const glm::ivec3 p = stack.back();
      stack.pop_back();
      for (int axis = 0; axis < 3; ++axis)
        for (const int step : {-1, 1}) {
          glm::ivec3 q = p;
          q[axis] += step;
          if (q[axis] < 0 || q[axis] >= n_ || at(q.x, q.y, q.z) != unknown) continue;
          state_[index(q.x, q.y, q.z)] = value;
          stack.push_back(q);
        }
    }
  }

  /// sums_[x, y, z]: inside cells with lower coordinates.
  void sum() {
    const int m = n_ + 1;
    sums_.assign(static_cast<std::size_t>(m) * static_cast<std::size_t>(m) * static_cast<std::size_t>(m), 0);
    for (int z = 1; z < m; ++z)
      for (int y = 1; y < m; ++y) {
        int row = 0;
        for (int x = 1; x < m; ++x) {
          row += at(x - 1, y - 1, z - 1) == inside ? 1 : 0;
          sums_[sum_index(x, y, z)] =
              row + sums_[sum_index(x, y - 1, z)] + sums_[sum_index(x, y, z - 1)] - sums_[sum_index(x, y - 1, z - 1)];
        }
      }
  }
  [[nodiscard]] std::size_t sum_index(int x, int y, int z) const {
    const auto m = static_cast<std::size_t>(n_) + 1;
    return (static_cast<std::size_t>(z) * m + static_cast<std::size_t>(y)) * m + static_cast<std::size_t>(x);
  }
  [[nodiscard]] bool solid(const glm::ivec3& lo, const glm::ivec3& hi) const {
    const auto s = [&](int x, int y, int z) { return sums_[sum_index(x, y, z)]; };
    const int count = s(hi.x, hi.y, hi.z) - s(lo.x, hi.y, hi.z) - s(hi.x, lo.y, hi.z) - s(hi.x, hi.y, lo.z) +
                      s(lo.x, lo.y, hi.z) + s(lo.x, hi.y, lo.z) + s(hi.x, lo.y, lo.z) - s(lo.x, lo.y, lo.z);
    const glm::ivec3 e = hi - lo;
    return count == e.x * e.y * e.z;
  }

  /// Grows a cell by the layer of cells that adds most surface, as long as there is one.
  [[nodiscard]] CellBox grow(const glm::ivec3& seed) const {
    CellBox box{seed, seed + 1, 0};
    box.area = area(box.lo, box.hi);
    while (true) {
      CellBox best = box;
      for (int axis = 0; axis < 3; ++axis)
        for (const int side : {0, 1}) {
          glm::ivec3 lo = box.lo, hi = box.hi;
          if (side == 0)
            --lo[axis];
          else
            ++hi[axis];
          if (lo[axis] < 0 || hi[axis] > n_ || !solid(lo, hi)) continue;
          if (const double a = area(lo, hi); a > best.area) best = {lo, hi, a};
        }
      if (best.area <= box.area) return box;
      box = best;
    }
  }
  [[nodiscard]] double area(const glm::ivec3& lo, const glm::ivec3& hi) const {
    const glm::dvec3 e = glm::dvec3(hi - lo) * step_;
    return 2 * (e.x * e.y + e.y * e.z + e.z * e.x);
  }

  const Mesh& mesh_;
  int n_;
  glm::dvec3 lo_, step_{0.0};
  std::vector<std::uint8_t> state_;
  std::vector<int> sums_;
};

}  // namespace

int winding_number(const Mesh& mesh, const glm::dvec3& point) {
  double total = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a = glm::dvec3(mesh.positions[t.x]) - point, b = glm::dvec3(mesh.positions[t.y]) - point,
                     c = glm::dvec3(mesh.positions[t.z]) - point;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    total += std::atan2(glm::dot(a, glm::cross(b, c)),
                        la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
  }
  return static_cast<int>(std::lround(total / (2 * 3.14159265358979323846)));
}

std::vector<Aabb> solid_boxes(const Mesh& mesh, const SolidBoxConfig& config) {
  std::vector<Aabb> boxes;
  const glm::vec3 extent = mesh.bounds.empty() ? glm::vec3(0.0f) : mesh.bounds.extent();
  // Too flat for a grid whose cells floats can tell apart.
  if (!mesh.closed || !(std::min({extent.x, extent.y, extent.z}) > 1e-4f * reach(mesh.bounds))) return boxes;
  Voxels voxels(mesh, config.cells);
  voxels.classify();
  std::vector<std::uint8_t> taken(voxels.cell_count(), 0);
  const double enough = config.gain * 2 * static_cast<double>(mesh.bounds.half_area());
  for (int i = 0; i < config.boxes; ++i) {
    const Voxels::CellBox box = voxels.largest(taken);
    if (!(box.area > enough)) break;
    voxels.take(box, taken);
    boxes.push_back(voxels.box_of(box));
  }
  return boxes;
}

}  // namespace sightline
