// The plain back-face test: the slides' numbers, SIMD against scalar on every target and tail.
#include "sightline/geometry/face_planes.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "sightline/scene/generate/random.hpp"

namespace sightline {
namespace {

/// 17.04: V = (-1, 0, -1); N1 = (2, 1, 2): -4, front; N2 = (-3, 1, -2): +5, back. V looks away from the eye (E35).
TEST(FacePlanes, TheSlidesNumbers) {
  const glm::dvec3 v(-1, 0, -1), n1(2, 1, 2), n2(-3, 1, -2);
  EXPECT_EQ(glm::dot(n1, v), -4.0);
  EXPECT_EQ(glm::dot(n2, v), 5.0);
  // The same through the kernel: an orthographic eye lies towards -v.
  FacePlanes planes;
  planes.count = 2;
  for (std::vector<float>* a : {&planes.x, &planes.y, &planes.z, &planes.offset}) a->assign(64, 0.0f);
  planes.x = {2, -3};
  planes.y = {1, 1};
  planes.z = {2, -2};
  for (std::vector<float>* a : {&planes.x, &planes.y, &planes.z}) a->resize(64);
  std::uint64_t kept = 0;
  front_faces_scalar(planes, {1, 0, 1, 0}, 1e-6f, &kept);
  EXPECT_EQ(kept, 1u);
  front_faces(planes, {1, 0, 1, 0}, 1e-6f, &kept);
  EXPECT_EQ(kept, 1u);
}

TEST(FacePlanes, PlaneOfATriangle) {
  const FacePlane plane = face_plane({0, 0, 2}, {3, 0, 2}, {0, 4, 2});
  EXPECT_EQ(plane.normal, glm::dvec3(0, 0, 1));
  EXPECT_DOUBLE_EQ(plane.offset, 2.0);
  EXPECT_DOUBLE_EQ(plane.height, 12.0 / 5.0);
  EXPECT_EQ(face_plane({0, 0, 0}, {1, 1, 1}, {2, 2, 2}).height, 0.0);
  EXPECT_EQ(face_plane({1, 2, 3}, {1, 2, 3}, {4, 5, 6}).height, 0.0);
}

TEST(FacePlanes, EveryTargetAndTailGivesTheReferencesAnswer) {
  Random random(5);
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().DeInit();
    for (std::size_t count = 1; count < 140; ++count) {
      std::vector<glm::vec3> positions;
      std::vector<glm::uvec3> triangles;
      for (std::uint32_t t = 0; t < count; ++t) {
        for (int k = 0; k < 3; ++k) positions.emplace_back(random.direction());
        triangles.push_back({3 * t, 3 * t + 1, t % 9 == 4 ? 3 * t : 3 * t + 2});
      }
      const FacePlanes planes = make_face_planes(positions, triangles, {});
      const glm::vec4 eye(glm::vec3(3.0 * random.direction()), count % 2 == 0 ? 1.0f : 0.0f);
      std::vector<std::uint64_t> a((count + 63) / 64, 7), b(a.size(), 9);
      front_faces(planes, eye, 1e-5f, a.data());
      front_faces_scalar(planes, eye, 1e-5f, b.data());
      EXPECT_EQ(a, b) << count << " on " << hwy::TargetName(target);
      for (std::uint32_t t = 0; t < count; ++t)  // no area: kept
        if (t % 9 == 4) {
          EXPECT_TRUE((b[t / 64] >> (t % 64)) & 1);
        }
    }
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
}

}  // namespace
}  // namespace sightline
