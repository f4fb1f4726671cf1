// The occupancy map hierarchy (Staneker, Bartz, Meissner 2003; checklist 22.11): one bit a pixel that says whether
// anything was drawn there, and above it the conjunction of 4 x 4 bits. Where a bit is missing nothing hides: the cheap
// test that saves an occlusion query.
#pragma once

#include <cstdint>
#include <vector>

namespace sightline {

class OccupancyMap {
 public:
  static constexpr int fan = 4;

  /// Sets the size in pixels (at least 1); nothing is occupied.
  void reset(int width, int height);
  [[nodiscard]] int level_count() const { return static_cast<int>(levels_.size()); }
  /// True if all pixels of the cell are occupied.
  [[nodiscard]] bool full(int level, int x, int y) const;
  /// Occupies a pixel, and what becomes full by it above.
  void occupy(int x, int y);
  /// True if every pixel of [x0, x1) x [y0, y1) is occupied, from coarse to fine. Adds looked-at cells to `cells`.
  [[nodiscard]] bool covers(int x0, int y0, int x1, int y1, std::uint64_t& cells) const;

 private:
  struct Level {
    int width, height;
    std::vector<std::uint8_t> open;  // cells of the level below (for pixels: 1) that are not full yet
  };
  static std::size_t index(const Level& level, int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(level.width) + static_cast<std::size_t>(x);
  }
  std::vector<Level> levels_;
};

}  // namespace sightline
