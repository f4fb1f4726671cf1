// The z-buffer of graphics hardware, simulated: depth in memory as 8 x 8 tiles, a status and the farthest depth of each
// tile on the chip, and every byte that crosses the bus counted (Morein 2000; checklist 5.06-5.14, 5.16). Each feature
// can be switched off to see what it gains. Depth is unorm24; the image is that of the plain z-buffer whatever is on.
#pragma once

#include <cstdint>
#include <vector>

#include "sightline/raster/setup.hpp"
#include "sightline/raster/tile_codec.hpp"

namespace sightline::raster {

enum class TileStatus : std::uint8_t { cleared, compressed, uncompressed };

struct TileFeatures {
  bool fast_clear = true;   // clearing sets the status only
  bool farthest = true;     // reject tests against zmax
  bool compression = true;  // tiles are stored compressed where that gains a quarter
};

struct TileTraffic {
  std::uint64_t read = 0, written = 0, cleared = 0;  // bytes on the bus
  std::uint64_t visits = 0;                          // triangle and tile pairs
  std::uint64_t rejected[3] = {0, 0, 0};             // by vertices, by plane corners, by all fragments (5.10-5.12)
  std::uint64_t fetches = 0;                         // all three tests failed
  std::uint64_t stored[3] = {0, 0, 0};               // tile writes by resulting status (cleared never)
  std::uint64_t fragments = 0, passes = 0;           // covered pixels of tiles that were fetched or rejected; writes
  [[nodiscard]] std::uint64_t total() const { return read + written + cleared; }
};

class TileMemory {
 public:
  TileMemory(int width, int height, const TileFeatures& features);

  /// glClear of depth to the far plane.
  void clear();
  /// Draws with LESS. `window`: corners in the window, depth 0 near to 1 far.
  void draw(const std::array<WindowPoint, 3>& window);

  [[nodiscard]] const TileTraffic& traffic() const { return traffic_; }
  [[nodiscard]] TileStatus status(int tile) const { return status_[static_cast<std::size_t>(tile)]; }
  [[nodiscard]] int across() const { return across_; }
  [[nodiscard]] int down() const { return down_; }
  /// Codes of a tile as memory holds them (decoded); pixels beyond the image are far.
  [[nodiscard]] DepthTile tile(int index) const;
  /// Size in memory now, bytes; 0 for a cleared tile.
  [[nodiscard]] std::size_t stored_bytes(int index) const;

 private:
  [[nodiscard]] DepthTile fetch(std::size_t index);
  void store(std::size_t index, const DepthTile& tile);

  int width_, height_, across_, down_;
  TileFeatures features_;
  TileTraffic traffic_;
  std::vector<TileStatus> status_;
  std::vector<std::uint32_t> farthest_;
  std::vector<PackedTile> memory_;
};

}  // namespace sightline::raster
