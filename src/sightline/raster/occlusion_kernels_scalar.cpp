// The same loops with one lane: the reference of the SIMD targets.
#define HWY_COMPILE_ONLY_SCALAR
#include <hwy/highway.h>

#include "sightline/raster/occlusion_kernels.inl.hpp"

namespace sightline::raster {

const Kernels& scalar_kernels() {
  namespace scalar = HWY_NAMESPACE;
  static const Kernels kernels{"scalar",       scalar::draw_mesh, scalar::fill_triangle, scalar::mark_contour,
                               scalar::commit, scalar::reduce,    scalar::hides};
  return kernels;
}

void Tiles::resize(int new_width, int new_height) {
  width = new_width;
  height = new_height;
  across = (width + tile_size - 1) / tile_size;
  down = (height + tile_size - 1) / tile_size;
  const auto count = static_cast<std::size_t>(across) * static_cast<std::size_t>(down);
  hidden.assign(count * tile_pixels, nothing_near);
  // Pixels of the last tiles that lie beyond the image must not keep a tile from counting as hidden.
  for (std::size_t i = 0; i < hidden.size(); ++i) {
    const auto tile = static_cast<int>(i / tile_pixels), lane = static_cast<int>(i % tile_pixels);
    const int x = tile % across * tile_size + lane % tile_size, y = tile / across * tile_size + lane / tile_size;
    if (x >= width || y >= height) hidden[i] = std::numeric_limits<float>::infinity();
  }
  layer.assign(count * tile_pixels, std::numeric_limits<float>::infinity());
  covered.assign(count, 0);
  contour.assign(count, 0);
  listed.assign(count, 0);
  touched.clear();
  farthest.assign(count, nothing_near);
}

}  // namespace sightline::raster
