#include "sightline/raster/tile_memory.hpp"

#include <algorithm>
#include <cmath>

#include "sightline/raster/coarse.hpp"
#include "sightline/raster/target.hpp"

namespace sightline::raster {
namespace {

constexpr std::uint32_t far_code = 0xFFFFFF;

DepthTile cleared_tile() {
  DepthTile tile;
  tile.fill(far_code);
  return tile;
}

std::uint32_t code_of(double z) { return depth_code(DepthFormat::unorm24, z); }

}  // namespace

TileMemory::TileMemory(int width, int height, const TileFeatures& features)
    : width_(width),
      height_(height),
      across_((width + coarse_size - 1) / coarse_size),
      down_((height + coarse_size - 1) / coarse_size),
      features_(features) {
  const auto tiles = static_cast<std::size_t>(across_) * static_cast<std::size_t>(down_);
  status_.assign(tiles, TileStatus::cleared);
  farthest_.assign(tiles, far_code);
  memory_.resize(tiles);
  clear();
}

void TileMemory::clear() {
  for (std::size_t i = 0; i < status_.size(); ++i) {
    farthest_[i] = far_code;
    status_[i] = TileStatus::cleared;
    if (features_.fast_clear) continue;
    status_[i] = TileStatus::uncompressed;
    memory_[i] = raw_tile(cleared_tile());
    traffic_.cleared += raw_tile_bytes;
  }
}

DepthTile TileMemory::tile(int index) const {
  DepthTile result = cleared_tile();
  if (status_[static_cast<std::size_t>(index)] != TileStatus::cleared)
    decode_tile(memory_[static_cast<std::size_t>(index)], result);
  return result;
}

std::size_t TileMemory::stored_bytes(int index) const {
  const auto i = static_cast<std::size_t>(index);
  if (status_[i] == TileStatus::cleared) return 0;
  return status_[i] == TileStatus::compressed ? memory_[i].size : raw_tile_bytes;
}

DepthTile TileMemory::fetch(std::size_t index) {
  ++traffic_.fetches;
  traffic_.read += stored_bytes(static_cast<int>(index));
  return tile(static_cast<int>(index));
}

void TileMemory::store(std::size_t index, const DepthTile& tile) {
  farthest_[index] = *std::max_element(tile.begin(), tile.end());
  memory_[index] = features_.compression ? encode_tile(tile) : raw_tile(tile);
  const bool gains = 4 * memory_[index].size <= 3 * raw_tile_bytes;  // else held packed, counted whole
  status_[index] = gains ? TileStatus::compressed : TileStatus::uncompressed;
  ++traffic_.stored[static_cast<std::size_t>(status_[index])];
  traffic_.written += stored_bytes(static_cast<int>(index));
}

void TileMemory::draw(const std::array<WindowPoint, 3>& window) {
  TriangleSetup t;
  if (!set_up(window, width_, height_, true, t)) return;
  const Plane3 z = plane_through(t, static_cast<double>(window[0].z), static_cast<double>(window[1].z),
                                 static_cast<double>(window[2].z));
  const double nearest_corner = std::min({window[0].z, window[1].z, window[2].z});
  // A plane evaluated at a centre may leave the range of its corners by a rounding: one code of room.
  const auto with_room = [](std::uint32_t code) { return code == 0 ? 0 : code - 1; };
  each_tile(t, [&](int x, int y, int w, int h, TileCover cover) {
    const auto index = static_cast<std::size_t>(y / coarse_size * across_ + x / coarse_size);
    ++traffic_.visits;
    const std::uint32_t farthest = farthest_[index];
    if (features_.farthest) {
      if (with_room(code_of(nearest_corner)) >= farthest) {
        ++traffic_.rejected[0];
        return;
      }
      const double corners = std::min({z.at(x, y), z.at(x + w - 1, y), z.at(x, y + h - 1), z.at(x + w - 1, y + h - 1)});
      if (with_room(code_of(corners)) >= farthest) {
        ++traffic_.rejected[1];
        return;
      }
    }
    std::array<std::uint32_t, 64> code{};
    std::uint64_t covered = 0;
    bool may_pass = false;
    each_pixel(t, x, y, w, h, cover, [&](int px, int py) {
      const auto at = static_cast<std::size_t>(py % coarse_size * coarse_size + px % coarse_size);
      covered |= std::uint64_t{1} << at;
      code[at] = code_of(z.at(px, py));
      may_pass = may_pass || code[at] < farthest;
      ++traffic_.fragments;
    });
    if (covered == 0) return;
    if (features_.farthest && !may_pass) {
      ++traffic_.rejected[2];
      return;
    }
    DepthTile tile = fetch(index);
    bool changed = false;
    for (std::size_t i = 0; i < 64; ++i) {
      if (((covered >> i) & 1) == 0 || code[i] >= tile[i]) continue;
      tile[i] = code[i];
      changed = true;
      ++traffic_.passes;
    }
    if (changed) store(index, tile);
  });
}

}  // namespace sightline::raster
