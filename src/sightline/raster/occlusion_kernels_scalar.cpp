// The same loops with one lane: the reference of the SIMD targets.
#define HWY_COMPILE_ONLY_SCALAR
#include <hwy/highway.h>

#include <algorithm>
#include <functional>

#include "sightline/parallel/parallel.hpp"
#include "sightline/raster/occlusion_prepare.inl.hpp"

namespace sightline::raster {

const Kernels& scalar_kernels() {
  namespace scalar = HWY_NAMESPACE;
  static const Kernels kernels{"scalar", scalar::draw, scalar::hides, scalar::hides_hull, scalar::project_boxes};
  return kernels;
}

void DrawList::clear() {
  runs.clear();
  surfaces.clear();
  triangles = edges = 0;
}

void DrawList::reserve(std::size_t more_triangles, std::size_t more_edges) {
  const auto grow = [](std::vector<float>& array, std::size_t wanted) {
    wanted += tile_pixels;  // whole vectors are read
    if (array.size() < wanted) array.resize(std::max(wanted, 2 * array.size()));
  };
  if (more_triangles > 0)
    for (std::size_t i = 0; i < 3; ++i)
      for (auto* array : {&x[i], &y[i], &near[i]}) grow(*array, triangles + more_triangles);
  if (more_edges > 0)
    for (std::size_t i = 0; i < 2; ++i)
      for (auto* array : {&edge_x[i], &edge_y[i], &edge_near[i]}) grow(*array, edges + more_edges);
}

void Tiles::resize(int new_width, int new_height) {
  width = new_width;
  height = new_height;
  across = (width + tile_size - 1) / tile_size;
  down = (height + tile_size - 1) / tile_size;
  const auto count = static_cast<std::size_t>(across) * static_cast<std::size_t>(down);
  constexpr std::size_t padding = tile_pixels;  // of `farthest`, which is read by whole vectors across tiles
  hidden.resize(count);
  farthest.resize(count + padding);
  constexpr std::size_t clear_together = 8192;  // half a megabyte
  const auto clear = [&](std::size_t begin, std::size_t end) {
    for (std::size_t tile = begin; tile < end; ++tile) std::fill_n(hidden[tile].lane, tile_pixels, nothing_near);
  };
  parallel_blocks(count, clear_together, std::ref(clear));
  std::fill(farthest.begin(), farthest.end(), nothing_near);
  // Pixels of the last tiles that lie beyond the image must not keep a tile from counting as hidden.
  for (int row = 0; row < down; ++row)
    for (int column = 0; column < across; ++column) {
      if (column < across - 1 && row < down - 1) column = across - 1;
      float* pixels = hidden[static_cast<std::size_t>(row * across + column)].lane;
      for (int lane = 0; lane < tile_pixels; ++lane)
        if (column * tile_size + lane % tile_size >= width || row * tile_size + lane / tile_size >= height)
          pixels[lane] = std::numeric_limits<float>::infinity();
    }
}

void Strip::begin(const Tiles& tiles, int first, int last) {
  first_column = first;
  last_column = last;
  triangles_filled = tiles_filled = 0;
  const std::size_t count = place(tiles.down, first);
  if (layer.size() >= count) return;  // drawing leaves it empty
  TilePixels empty;
  std::fill_n(empty.lane, tile_pixels, std::numeric_limits<float>::infinity());
  layer.assign(count, empty);
  places.assign(count, {});
}

}  // namespace sightline::raster
