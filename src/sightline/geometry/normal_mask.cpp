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
  for (std::size_t block = 0; block < 16; ++block)
    if (std::any_of(mask.begin() + static_cast<std::ptrdiff_t>(16 * block),
                    mask.begin() + static_cast<std::ptrdiff_t>(16 * block + 16), [](std::uint8_t b) { return b != 0; }))
      blocks[used++] = static_cast<std::uint8_t>(block);
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

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {

HWY_EXPORT(front_by_mask_simd);

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
      for (int column = 0; column <= n; ++column)
        corners_.emplace_back(glm::normalize(on_face(face, 2.0 * column / n - 1.0, 2.0 * row / n - 1.0)));
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

namespace {

/// Per corner normal the least n . v over the directions of one sector.
void least_products(std::span<const glm::vec3> normals, std::span<const glm::vec3> directions,
                    std::vector<float>& least) {
  for (std::size_t i = 0; i < normals.size(); ++i) {
    float low = glm::dot(normals[i], directions[0]);
    for (std::size_t k = 1; k < directions.size(); ++k) low = std::min(low, glm::dot(normals[i], directions[k]));
    least[i] = low;
  }
}

void set_classes(const DirectionCube& cube, const std::vector<float>& least, float margin, BackMask& mask) {
  const auto n = static_cast<std::size_t>(cube.n()), across = n + 1;
  mask.fill(0);
  std::size_t normal_class = 0;
  for (std::size_t face = 0; face < 6; ++face)
    for (std::size_t row = 0; row < n; ++row) {
      const float* low = least.data() + (face * across + row) * across;
      for (std::size_t column = 0; column < n; ++column, ++low, ++normal_class) {
        const bool back = std::min(std::min(low[0], low[1]), std::min(low[across], low[across + 1])) >= margin;
        mask[normal_class >> 3] |= static_cast<std::uint8_t>((back ? 1 : 0) << (normal_class & 7));
      }
    }
}

}  // namespace

void back_masks(const DirectionCube& cube, std::span<const glm::vec3> directions, int sectors, float margin,
                std::span<BackMask> masks) {
  std::vector<float> least(cube.corners().size());
  if (directions.size() == 1) {
    least_products(cube.corners(), directions, least);
    set_classes(cube, least, margin, masks[0]);
    return;
  }
  const auto across = static_cast<std::size_t>(sectors) + 1;
  std::size_t sector = 0;
  for (std::size_t row = 0; row + 1 < across; ++row)
    for (std::size_t column = 0; column + 1 < across; ++column, ++sector) {
      const std::size_t at = row * across + column;
      const std::array<glm::vec3, 4> four{directions[at], directions[at + 1], directions[at + across],
                                          directions[at + across + 1]};
      least_products(cube.corners(), four, least);
      set_classes(cube, least, margin, masks[sector]);
    }
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
