#include "heat_picture.hpp"

#include <algorithm>
#include <cmath>

#include "sightline/raster/depth_precision.hpp"
#include "sightline/raster/tile_codec.hpp"

namespace sightline::cli {
namespace {

glm::vec3 heat(double t) {
  constexpr glm::vec3 stops[] = {{0.06f, 0.07f, 0.20f},
                                 {0.10f, 0.35f, 0.65f},
                                 {0.20f, 0.65f, 0.40f},
                                 {0.95f, 0.85f, 0.25f},
                                 {0.85f, 0.15f, 0.12f}};
  const double at = std::clamp(t, 0.0, 1.0) * 4.0;
  const int i = std::min(3, static_cast<int>(at));
  return glm::mix(stops[i], stops[i + 1], static_cast<float>(at - i));
}

void put(Picture& picture, const glm::vec3& colour) {
  for (int k = 0; k < 3; ++k) picture.rgb.push_back(static_cast<std::uint8_t>(std::lround(255.0f * colour[k])));
}

/// Window depth in 24 bits; the background is the far plane.
std::uint32_t code_of(const View& view, float distance) {
  if (std::isinf(distance)) return 0xFFFFFF;
  const double far = std::isinf(view.far) ? 1e9 : view.far, d = static_cast<double>(distance);
  return raster::depth_code(raster::DepthFormat::unorm24, view.projection == Projection::perspective
                                                              ? raster::window_depth(d, view.near, far)
                                                              : (d - view.near) / (far - view.near));
}

glm::vec3 tile_colour(const View& view, const Frame& frame, int x, int y) {
  raster::DepthTile tile;
  bool cleared = true;
  for (int i = 0; i < 64; ++i) {
    const float d =
        frame.depth[frame.index(std::min(x + i % 8, frame.width - 1), std::min(y + i / 8, frame.height - 1))];
    cleared = cleared && std::isinf(d);
    tile[static_cast<std::size_t>(i)] = code_of(view, d);
  }
  if (cleared) return {0.06f, 0.07f, 0.10f};
  const double share = static_cast<double>(raster::encode_tile(tile).size) / raster::raw_tile_bytes;
  if (share > 0.75) return {0.80f, 0.20f, 0.15f};
  return glm::mix(glm::vec3(0.35f, 0.85f, 0.45f), glm::vec3(0.10f, 0.25f, 0.15f), static_cast<float>(share));
}

}  // namespace

template <class Count>
Picture paint_counts(int width, int height, std::span<const Count> counts, double most) {
  Picture picture{width, height, {}};
  picture.rgb.reserve(counts.size() * 3);
  for (const Count c : counts) put(picture, heat(static_cast<double>(c) / most));
  return picture;
}
template Picture paint_counts(int, int, std::span<const std::uint32_t>, double);
template Picture paint_counts(int, int, std::span<const std::uint8_t>, double);

Picture paint_tiles(const View& view, const Frame& frame) {
  std::vector<glm::vec3> colours;
  for (int y = 0; y < frame.height; y += 8)
    for (int x = 0; x < frame.width; x += 8) colours.push_back(tile_colour(view, frame, x, y));
  const auto across = static_cast<std::size_t>((frame.width + 7) / 8);
  Picture picture{frame.width, frame.height, {}};
  for (std::size_t y = 0; y < static_cast<std::size_t>(frame.height); ++y)
    for (std::size_t x = 0; x < static_cast<std::size_t>(frame.width); ++x)
      put(picture, colours[y / 8 * across + x / 8]);
  return picture;
}

}  // namespace sightline::cli
