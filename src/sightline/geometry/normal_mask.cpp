#include "sightline/geometry/normal_mask.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sightline/geometry/normal_mask.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR
std::size_t front_by_mask_simd(const std::uint8_t* byte_offset, const std::uint8_t* bit_mask, std::size_t count,
                               const BackMask& mask, std::uint64_t* kept) {
  return front_by_mask_scalar(byte_offset, bit_mask, count, mask, kept);
}
#else
/// The mask lies in registers, 16 bytes each; a table look-up by bytes gives 0 for offsets that belong to another one.
std::size_t front_by_mask_simd(const std::uint8_t* byte_offset, const std::uint8_t* bit_mask, std::size_t count,
                               const BackMask& mask, std::uint64_t* kept) {
  const hn::CappedTag<std::uint8_t, 64> d;
  const std::size_t lanes = hn::Lanes(d);
  std::uint8_t blocks[16];  // those with a bit set: about half of a view's mask is empty
  std::size_t used = 0;
  for (std::size_t block = 0; block < 16; ++block) {
    std::uint64_t half[2];
    std::memcpy(half, mask.data() + 16 * block, 16);
    if ((half[0] | half[1]) != 0) blocks[used++] = static_cast<std::uint8_t>(block);
  }
  const auto overflow = hn::Set(d, std::uint8_t{0x70});
  std::size_t culled_polygons = 0;
  for (std::size_t first = 0; first < count; first += 64) {
    std::uint8_t bytes[16] = {};
    for (std::size_t k = 0; k < 64; k += lanes) {
      const auto offset = hn::LoadU(d, byte_offset + first + k);
      auto found = hn::Zero(d);
      for (std::size_t b = 0; b < used; ++b) {
        // 0 .. 15 become 0x70 .. 0x7F, all others have the highest bit set.
        const auto within =
            hn::SaturatedAdd(hn::Sub(offset, hn::Set(d, static_cast<std::uint8_t>(16 * blocks[b]))), overflow);
        found = hn::Or(found, hn::TableLookupBytesOr0(hn::LoadDup128(d, mask.data() + 16 * blocks[b]), within));
      }
      const auto culled = hn::And(found, hn::LoadU(d, bit_mask + first + k));
      hn::StoreMaskBits(d, hn::Eq(culled, hn::Zero(d)), bytes + k / 8);
    }
    std::uint64_t word;
    std::memcpy(&word, bytes, 8);
    if (count - first < 64) word &= (std::uint64_t{1} << (count - first)) - 1;
    kept[first / 64] = word;
    culled_polygons += std::min<std::size_t>(64, count - first) - hwy::PopCount(word);
  }
  return culled_polygons;
}
#endif

/// Per corner normal the least n . v over the directions.
void least_products(const DirectionCube& cube, std::span<const glm::vec3> directions, std::span<float> least) {
  const hn::CappedTag<float, 16> d;
  const auto& [x, y, z] = cube.corners();
  for (std::size_t i = 0; i < x.size(); i += hn::Lanes(d)) {
    const auto nx = hn::LoadU(d, x.data() + i), ny = hn::LoadU(d, y.data() + i), nz = hn::LoadU(d, z.data() + i);
    auto low = hn::Set(d, 2.0f);
    for (const glm::vec3& v : directions) {
      const auto product =
          hn::Add(hn::Add(hn::Mul(nx, hn::Set(d, v.x)), hn::Mul(ny, hn::Set(d, v.y))), hn::Mul(nz, hn::Set(d, v.z)));
      low = hn::Min(low, product);
    }
    hn::StoreU(low, d, least.data() + i);
  }
}

void back_mask_simd(const DirectionCube& cube, std::span<const glm::vec3> directions, float margin, BackMask& mask) {
  constexpr std::size_t most = 6 * 19 * 19 + 32;
  std::array<float, most> least{};  // more than the corners: loads run over their end
  least_products(cube, directions, least);
  const hn::CappedTag<float, 16> d;
  const std::size_t lanes = hn::Lanes(d), n = static_cast<std::size_t>(cube.n()), across = n + 1;
  mask.fill(0);
  std::size_t first = 0;  // class
  for (std::size_t face = 0; face < 6; ++face)
    for (std::size_t row = 0; row < n; ++row, first += n) {
      const float* const low = least.data() + (face * across + row) * across;
      std::uint32_t bits = 0;
      for (std::size_t k = 0; k < n; k += lanes) {
        const auto left = hn::Min(hn::LoadU(d, low + k), hn::LoadU(d, low + across + k));
        const auto right = hn::Min(hn::LoadU(d, low + k + 1), hn::LoadU(d, low + across + k + 1));
        std::uint8_t bytes[8] = {};
        hn::StoreMaskBits(d, hn::Ge(hn::Min(left, right), hn::Set(d, margin)), bytes);
        bits |= static_cast<std::uint32_t>(bytes[0] | (bytes[1] << 8)) << k;
      }
      bits = (bits & ((1u << n) - 1u)) << (first & 7);  // 18 + 7 bits at most
      for (std::size_t byte = first >> 3; bits != 0; ++byte, bits >>= 8) mask[byte] |= static_cast<std::uint8_t>(bits);
    }
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {

HWY_EXPORT(front_by_mask_simd);
HWY_EXPORT(back_mask_simd);

namespace {

glm::dvec3 on_face(int face, double u, double v) {
  const int axis = face / 2;
  glm::dvec3 p(0.0);
  p[axis] = face % 2 == 0 ? 1.0 : -1.0;
  p[(axis + 1) % 3] = u;
  p[(axis + 2) % 3] = v;
  return p;
}

}  // namespace

DirectionCube::DirectionCube(int n) : n_(n) {
  for (int face = 0; face < 6; ++face)
    for (int row = 0; row <= n; ++row)
      for (int column = 0; column <= n; ++column) {
        const glm::vec3 corner(glm::normalize(on_face(face, 2.0 * column / n - 1.0, 2.0 * row / n - 1.0)));
        for (int axis = 0; axis < 3; ++axis) corners_[static_cast<std::size_t>(axis)].push_back(corner[axis]);
      }
  for (std::vector<float>& coordinate : corners_) coordinate.resize((coordinate.size() + 15) / 16 * 16);
}

int DirectionCube::class_of(const glm::dvec3& direction) const {
  const glm::dvec3 size = glm::abs(direction);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const int face = 2 * axis + (direction[axis] < 0.0 ? 1 : 0);
  const auto cell = [&](double coordinate) {
    return std::clamp(static_cast<int>(std::floor(0.5 * (coordinate / size[axis] + 1.0) * n_)), 0, n_ - 1);
  };
  return (face * n_ + cell(direction[(axis + 2) % 3])) * n_ + cell(direction[(axis + 1) % 3]);
}

BackMask back_mask(const DirectionCube& cube, std::span<const glm::vec3> directions, float margin) {
  BackMask mask;
  HWY_DYNAMIC_DISPATCH(back_mask_simd)(cube, directions, margin, mask);
  return mask;
}

std::size_t front_by_mask(const std::uint8_t* byte_offset, const std::uint8_t* bit_mask, std::size_t count,
                          const BackMask& mask, std::uint64_t* kept) {
  return HWY_DYNAMIC_DISPATCH(front_by_mask_simd)(byte_offset, bit_mask, count, mask, kept);
}

std::size_t front_by_mask_scalar(const std::uint8_t* byte_offset, const std::uint8_t* bit_mask, std::size_t count,
                                 const BackMask& mask, std::uint64_t* kept) {
  std::size_t culled = 0;
  for (std::size_t first = 0; first < count; first += 64) {
    std::uint64_t word = 0;
    const std::size_t end = std::min(count, first + 64);
    for (std::size_t i = first; i < end; ++i) {
      const bool back = (mask[byte_offset[i]] & bit_mask[i]) != 0;
      word |= static_cast<std::uint64_t>(back ? 0 : 1) << (i - first);
      culled += back ? 1 : 0;
    }
    kept[first / 64] = word;
  }
  return culled;
}

}  // namespace sightline
#endif
