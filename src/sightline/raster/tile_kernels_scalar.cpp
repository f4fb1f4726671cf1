// The same loops with one lane: the reference of the SIMD targets.
#define HWY_COMPILE_ONLY_SCALAR
#include <hwy/highway.h>

#include "sightline/raster/tile_kernels.inl.hpp"

namespace sightline::raster {

const TileKernels& scalar_tile_kernels() {
  namespace scalar = HWY_NAMESPACE::tile_loops;
  static const TileKernels kernels{"scalar",     scalar::transform, scalar::draw,
                                   scalar::cull, scalar::project,   scalar::hidden};
  return kernels;
}

}  // namespace sightline::raster
