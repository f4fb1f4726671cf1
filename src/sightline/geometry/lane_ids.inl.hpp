// The lanes of a mask as numbers: what loops over many things use to list those that pass. Highway's own CompressStore
// copies its table to the stack at every call with AVX2 (GCC 12), which costs more than the test before it. Included by
// SIMD sources, once per target.

#if defined(SIGHTLINE_GEOMETRY_LANE_IDS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SIGHTLINE_GEOMETRY_LANE_IDS_INL
#undef SIGHTLINE_GEOMETRY_LANE_IDS_INL
#else
#define SIGHTLINE_GEOMETRY_LANE_IDS_INL
#endif

#include <hwy/highway.h>

#include <bit>
#include <cstddef>
#include <cstdint>

#include "sightline/geometry/lane_ids.hpp"

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

/// Writes first + l for every set lane l of `mask`, ascending; returns how many. `ids` must have room for a whole
/// vector, of 4-byte integers.
template <class D, class Mask, class Id>
HWY_INLINE std::size_t store_lane_ids(D d, Mask mask, std::size_t first, Id* ids) {
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::RebindToSigned<D> di;
  auto* out = reinterpret_cast<std::int32_t*>(ids);
  const auto start = static_cast<std::int32_t>(first);
  if constexpr (hn::MaxLanes(D()) > 8) {
    return hn::CompressStore(hn::Iota(di, start), hn::RebindMask(di, mask), di, out);
  } else {
    const hn::Rebind<std::uint8_t, D> bytes;
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, mask, bits);
    const auto lanes = hn::PromoteTo(di, hn::LoadU(bytes, lanes_of_bits[bits[0]].data()));
    hn::StoreU(hn::Add(lanes, hn::Set(di, start)), di, out);
    return static_cast<std::size_t>(std::popcount(bits[0]));
  }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
