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
  for (int row = 0; row < down; ++row)
    for (int column = 0; column < across; ++column) {
      if (column < across - 1 && row < down - 1) column = across - 1;
      float* pixels = hidden.data() + static_cast<std::size_t>(row * across + column) * tile_pixels;
      for (int lane = 0; lane < tile_pixels; ++lane)
        if (column * tile_size + lane % tile_size >= width || row * tile_size + lane / tile_size >= height)
          pixels[lane] = std::numeric_limits<float>::infinity();
    }
  layer.assign(count * tile_pixels, std::numeric_limits<float>::infinity());
  covered.assign(count, 0);
  contour.assign(count, 0);
  listed.assign(count, 0);
  touched.clear();
  farthest.assign(count, nothing_near);
}

}  // namespace sightline::raster
