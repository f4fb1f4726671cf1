// Every SIMD target that the compiler can make, chosen at run time (Highway).
#include "sightline/raster/tile_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sightline/raster/tile_kernels_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sightline/raster/tile_kernels.inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::raster::HWY_NAMESPACE {

inline const TileKernels* tile_table() {
  static const TileKernels kernels{
      hwy::TargetName(HWY_TARGET), tile_loops::transform, tile_loops::draw, tile_loops::cull,
      tile_loops::project,         tile_loops::hidden};
  return &kernels;
}

}  // namespace sightline::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::raster {

HWY_EXPORT(tile_table);
const TileKernels& simd_tile_kernels() { return *HWY_DYNAMIC_DISPATCH(tile_table)(); }

}  // namespace sightline::raster
#endif
