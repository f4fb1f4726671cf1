// Every SIMD target that the compiler can make, chosen at run time (Highway).
#include "sightline/raster/occlusion_kernels.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sightline/raster/occlusion_kernels_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "sightline/raster/occlusion_prepare.inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::raster::HWY_NAMESPACE {

inline const Kernels* table() {
  static const Kernels kernels{hwy::TargetName(HWY_TARGET), draw, hides, hides_hull, project_boxes};
  return &kernels;
}

}  // namespace sightline::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::raster {

HWY_EXPORT(table);
const Kernels& simd_kernels() { return *HWY_DYNAMIC_DISPATCH(table)(); }

}  // namespace sightline::raster
#endif
