#include "sightline/geometry/face_planes.hpp"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "sightline/geometry/face_planes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

std::size_t front_faces_simd(const FacePlanes& planes, const glm::vec4& eye, float slack, std::uint64_t* kept) {
  const hn::CappedTag<float, 16> d;
  const std::size_t lanes = hn::Lanes(d);
  const auto ex = hn::Set(d, eye.x), ey = hn::Set(d, eye.y), ez = hn::Set(d, eye.z), ew = hn::Set(d, eye.w);
  const auto limit = hn::Set(d, -slack);
  std::size_t culled = 0;
  for (std::size_t first = 0; first < planes.count; first += 64) {
    std::uint64_t back = 0;
    for (std::size_t k = 0; k < 64; k += lanes) {
      const std::size_t i = first + k;
      const auto x = hn::Mul(hn::LoadU(d, planes.x.data() + i), ex);
      const auto y = hn::Mul(hn::LoadU(d, planes.y.data() + i), ey);
      const auto z = hn::Mul(hn::LoadU(d, planes.z.data() + i), ez);
      const auto offset = hn::Mul(hn::LoadU(d, planes.offset.data() + i), ew);
      std::uint8_t bytes[8] = {};
      hn::StoreMaskBits(d, hn::Le(hn::Sub(hn::Add(hn::Add(x, y), z), offset), limit), bytes);
      back |= static_cast<std::uint64_t>(bytes[0] | (bytes[1] << 8)) << k;
    }
    kept[first / 64] = ~back;
    culled += hwy::PopCount(back);  // the padding is kept
  }
  if (planes.count % 64 != 0) kept[planes.count / 64] &= (std::uint64_t{1} << (planes.count % 64)) - 1;
  return culled;
}

}  // namespace sightline::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline {

HWY_EXPORT(front_faces_simd);

FacePlane face_plane(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 cross = glm::cross(b - a, c - a);
  const double area = glm::length(cross),
               longest = std::max({glm::length(b - a), glm::length(c - b), glm::length(a - c)});
  // Below that the cross product of doubles is noise.
  if (!(area > 1e-12 * longest * longest) || !(area > 1e-280)) return {};
  const glm::dvec3 normal = cross / area;
  return {normal, glm::dot(normal, a), area / longest};
}

FacePlanes make_face_planes(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                            const glm::vec3& origin, std::span<const std::uint32_t> order) {
  FacePlanes planes;
  planes.count = order.empty() ? triangles.size() : order.size();
  const std::size_t padded = (planes.count + 63) / 64 * 64;
  for (std::vector<float>* v : {&planes.x, &planes.y, &planes.z, &planes.offset}) v->assign(padded, 0.0f);
  glm::vec3 lo(std::numeric_limits<float>::infinity()), hi(-lo);
  for (const glm::vec3& p : positions) {
    lo = glm::min(lo, p);
    hi = glm::max(hi, p);
  }
  planes.extent = planes.count == 0 ? 0.0f : 1.000001f * glm::length(hi - lo);
  const glm::dvec3 shift(origin);
  for (std::size_t i = 0; i < planes.count; ++i) {
    const glm::uvec3& t = triangles[order.empty() ? i : order[i]];
    const FacePlane plane = face_plane(glm::dvec3(positions[t.x]) - shift, glm::dvec3(positions[t.y]) - shift,
                                       glm::dvec3(positions[t.z]) - shift);
    const double scale = plane.height > 0.0 ? plane.height / planes.extent : 0.0;
    planes.x[i] = static_cast<float>(plane.normal.x * scale);
    planes.y[i] = static_cast<float>(plane.normal.y * scale);
    planes.z[i] = static_cast<float>(plane.normal.z * scale);
    planes.offset[i] = static_cast<float>(plane.offset * scale);
  }
  return planes;
}

std::size_t front_faces(const FacePlanes& planes, const glm::vec4& eye, float slack, std::uint64_t* kept) {
  return HWY_DYNAMIC_DISPATCH(front_faces_simd)(planes, eye, slack, kept);
}

std::size_t front_faces_scalar(const FacePlanes& planes, const glm::vec4& eye, float slack, std::uint64_t* kept) {
  std::size_t culled = 0;
  for (std::size_t first = 0; first < planes.count; first += 64) {
    std::uint64_t word = 0;
    const std::size_t end = std::min(planes.count, first + 64);
    for (std::size_t i = first; i < end; ++i) {
      const float side = planes.x[i] * eye.x + planes.y[i] * eye.y + planes.z[i] * eye.z - planes.offset[i] * eye.w;
      word |= static_cast<std::uint64_t>(side <= -slack ? 0 : 1) << (i - first);
      culled += side <= -slack ? 1 : 0;
    }
    kept[first / 64] = word;
  }
  return culled;
}

}  // namespace sightline
#endif
