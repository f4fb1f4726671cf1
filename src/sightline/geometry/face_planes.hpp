// The planes of triangles as arrays, and which of them turn their back to an eye: the plain back-face test (checklist
// 17.03, E35), one by one (the reference) or in SIMD; both give the same bits. Promise: conservative by the slack
// given.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace sightline {

/// A triangle's plane relative to an origin: unit normal (counter-clockwise side), offset = normal . corner, and the
/// triangle's least height. A triangle without area has normal 0 and height 0.
struct FacePlane {
  glm::dvec3 normal{0.0};
  double offset = 0.0, height = 0.0;
};
FacePlane face_plane(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

/// Planes scaled by height / `extent`, so that one number is slack enough for all: a thin triangle, whose normal moves
/// when its corners are rounded, loses certainty in proportion. Padded with planes of normal 0.
struct FacePlanes {
  std::size_t count = 0;
  float extent = 0.0f;  // at least every height
  std::vector<float> x, y, z, offset;
};

/// Positions minus `origin`; `order` lists the triangles to take, empty for all.
FacePlanes make_face_planes(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                            const glm::vec3& origin, std::span<const std::uint32_t> order = {});

/// Bit i of `kept` (64 to a word, ceil(count / 64) words) is clear iff n . eye.xyz - offset * eye.w <= -slack for the
/// scaled plane i: with slack > 0 a triangle without area is kept. Returns how many bits are clear.
std::size_t front_faces(const FacePlanes& planes, const glm::vec4& eye, float slack, std::uint64_t* kept);
std::size_t front_faces_scalar(const FacePlanes& planes, const glm::vec4& eye, float slack, std::uint64_t* kept);

}  // namespace sightline
