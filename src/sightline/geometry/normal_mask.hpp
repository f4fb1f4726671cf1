// Normals in classes, a bit for each (Zhang and Hoff 1997, checklist 18): a direction cube of 6 N^2 classes; a polygon
// keeps two bytes; for a view a mask of 2048 bits says which classes turn their backs wherever in the image they lie.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace sightline {

/// The cube around the unit sphere of directions, each face cut into N x N equal squares (18.02). Class = (face * N +
/// row) * N + column; face 2 * axis, + 1 for the negative half axis (u, v, d per face).
class DirectionCube {
 public:
  /// 1 <= n <= 18: 6 n^2 classes must fit 2048 bits (18.04).
  explicit DirectionCube(int n);
  [[nodiscard]] int n() const { return n_; }
  [[nodiscard]] int classes() const { return 6 * n_ * n_; }
  /// Class of a direction of any length but 0.
  [[nodiscard]] int class_of(const glm::dvec3& direction) const;
  /// Coordinates of the unit directions of the corners of all squares, at (face * (n + 1) + row) * (n + 1) + column;
  /// padded with 0 for vectors of 16.
  [[nodiscard]] const std::array<std::vector<float>, 3>& corners() const { return corners_; }

 private:
  int n_;
  std::array<std::vector<float>, 3> corners_;
};

/// What a polygon keeps (18.04). A mask of 0 is never culled.
struct PolygonNormalMask {
  std::uint8_t byte_offset = 0, bit_mask = 0;
};
inline PolygonNormalMask polygon_normal_mask(int normal_class) {
  return {static_cast<std::uint8_t>(normal_class >> 3), static_cast<std::uint8_t>(1 << (normal_class & 7))};
}

/// BackMask[byteOffset] & bitMask != 0: culled (18.08).
using BackMask = std::array<std::uint8_t, 256>;

/// The mask for a part of the image (18.06, 18.07, 18.09). `directions`: the unit directions from the eye through its
/// four corners; a single one for an orthographic view (18.05). A class is set if n . v >= margin for all unit normals
/// n of the class and unit directions v of the part: 4 corner normals x 4 corner directions decide. margin > 1e-6
/// covers rounding.
BackMask back_mask(const DirectionCube& cube, std::span<const glm::vec3> directions, float margin);

/// Bit i of `kept` is set unless polygon i of the arrays is culled by the mask. Arrays are padded to a multiple of 64.
/// Returns how many bits are clear.
std::size_t front_by_mask(const std::uint8_t* byte_offset, const std::uint8_t* bit_mask, std::size_t count,
                          const BackMask& mask, std::uint64_t* kept);
std::size_t front_by_mask_scalar(const std::uint8_t* byte_offset, const std::uint8_t* bit_mask, std::size_t count,
                                 const BackMask& mask, std::uint64_t* kept);

}  // namespace sightline
