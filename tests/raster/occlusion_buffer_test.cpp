// The occlusion buffer by itself: what it must hide, what it must never hide, and the same bits from every set of
// loops.
#include "sightline/raster/occlusion_buffer.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "agreement/cases.hpp"

namespace sightline {
namespace {

OccluderMesh occluder(const Mesh& mesh) { return make_occluder(mesh.positions, mesh.triangles); }

View front_view(int width = 320, int height = 180) {
  View view = look_along({0, 0, 0}, {0, 0, -1});
  view.width = width;
  view.height = height;
  return view;
}

Aabb box_at(const glm::vec3& centre, float half) { return {centre - half, centre + half}; }

TEST(OcclusionBuffer, NothingIsHiddenWithoutOccluders) {
  OcclusionBuffer buffer;
  buffer.begin(front_view(), 80, 45);
  EXPECT_TRUE(buffer.may_be_seen(box_at({0, 0, -10}, 1)));
  EXPECT_TRUE(std::isinf(buffer.hidden_beyond(40, 22)));
}

TEST(OcclusionBuffer, AWallHidesWhatIsBehindItAndNothingElse) {
  const OccluderMesh wall = occluder(cases::quad({-20, -20, -5}, {40, 0, 0}, {0, 40, 0}));
  for (const int width : {1, 7, 40, 320}) {
    OcclusionBuffer buffer;
    buffer.begin(front_view(), width, std::max(1, width * 9 / 16));
    buffer.add_occluder(wall, identity_affine());
    EXPECT_FALSE(buffer.may_be_seen(box_at({0, 0, -8}, 1))) << width;
    EXPECT_FALSE(buffer.may_be_seen(box_at({0, 0, -5.1f}, 0.05f))) << width;
    EXPECT_TRUE(buffer.may_be_seen(box_at({0, 0, -3}, 1))) << width;
    EXPECT_TRUE(buffer.may_be_seen(box_at({0, 0, -5}, 0.5f))) << width << ": reaches through the wall";
    EXPECT_NEAR(buffer.hidden_beyond(width / 2, 0), 5.0f, 0.01f);
  }
}

TEST(OcclusionBuffer, TheInnerEdgesOfAFineMeshLeaveNoSeam) {
  Mesh grid;
  constexpr std::uint32_t n = 150;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i)
      grid.positions.emplace_back(-20 + 40.0f * static_cast<float>(i) / n, -20 + 40.0f * static_cast<float>(j) / n, -5);
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i, b = a + n + 1;
      grid.triangles.push_back({a, a + 1, b + 1});
      grid.triangles.push_back({a, b + 1, b});
    }
  OcclusionBuffer buffer;
  buffer.begin(front_view(), 64, 36);
  buffer.add_occluder(occluder(grid), identity_affine());
  for (int y = 0; y < 36; ++y)
    for (int x = 0; x < 64; ++x) EXPECT_NEAR(buffer.hidden_beyond(x, y), 5.0f, 0.01f) << x << ' ' << y;
}

TEST(OcclusionBuffer, AGapIsNeverClosedHoweverThin) {
  for (const float gap : {0.3f, 0.01f, 1e-4f}) {
    const OccluderMesh half = occluder(cases::quad({0, -20, 0}, {20, 0, 0}, {0, 40, 0}));
    OcclusionBuffer buffer;
    buffer.begin(front_view(), 64, 36);
    buffer.add_occluder(half, cases::at({0.37f + gap, 0, -5}));
    buffer.add_occluder(half, cases::at({0.37f - 20, 0, -5}));
    EXPECT_TRUE(buffer.may_be_seen(box_at({0.37f * 2, 0, -10}, 0.2f))) << gap;
    EXPECT_FALSE(buffer.may_be_seen(box_at({4, 0, -10}, 0.5f))) << gap;
  }
}

TEST(OcclusionBuffer, OccludersBeforeTheNearPlaneAndAcrossIt) {
  const Mesh floor = cases::quad({-50, -1, 50}, {100, 0, 0}, {0, 0, -100});  // runs below and behind the eye
  View view = front_view();
  view.near = 0.5;
  OcclusionBuffer buffer;
  buffer.begin(view, 160, 90);
  buffer.add_occluder(occluder(floor), identity_affine());
  buffer.add_occluder(occluder(cases::quad({-9, -9, -0.3f}, {18, 0, 0}, {0, 18, 0})), identity_affine());  // before it
  EXPECT_FALSE(buffer.may_be_seen(box_at({0, -3, -10}, 0.5f))) << "under the floor";
  EXPECT_TRUE(buffer.may_be_seen(box_at({0, 1, -10}, 0.5f))) << "above the floor";
  EXPECT_TRUE(buffer.may_be_seen(box_at({0, 0, 0}, 1))) << "around the eye";
  EXPECT_FALSE(buffer.may_be_seen(box_at({0, 0, 9}, 1))) << "behind the eye";
}

TEST(OcclusionBuffer, OrthographicViews) {
  View view = front_view();
  view.projection = Projection::orthographic;
  view.span_y = 10;
  OcclusionBuffer buffer;
  buffer.begin(view, 80, 45);
  buffer.add_occluder(occluder(cases::quad({-2, -2, -5}, {4, 0, 0}, {0, 4, 0})), identity_affine());
  EXPECT_FALSE(buffer.may_be_seen(box_at({0, 0, -100}, 1.5f)));
  EXPECT_TRUE(buffer.may_be_seen(box_at({1, 0, -100}, 1.5f))) << "peeks out at the side";
  EXPECT_TRUE(buffer.may_be_seen(box_at({0, 0, -3}, 1)));
}

TEST(OcclusionBuffer, ClosedMeshesDrawFrontFacesMirroredOnesToo) {
  const OccluderMesh box = occluder(cases::cube(2));
  for (const float sign : {1.0f, -1.0f}) {
    OcclusionBuffer buffer;
    buffer.begin(front_view(), 80, 45);
    buffer.add_occluder(box, {{sign, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -8}});
    EXPECT_EQ(buffer.counts().triangles_filled, 2u);
    EXPECT_NEAR(buffer.hidden_beyond(40, 22), 6.0f, 0.01f) << "the front face, not the back one";
  }
}

/// All pixels of a buffer over a scene, as bits.
std::vector<float> pixels(const Scene& scene, const View& view, bool scalar) {
  OcclusionBuffer buffer(scalar);
  buffer.begin(view, 101, 57);
  std::vector<OccluderMesh> meshes;
  for (const Mesh& mesh : scene.meshes()) meshes.push_back(occluder(mesh));
  for (const Object& object : scene.objects()) buffer.add_occluder(meshes[object.mesh], object.transform);
  std::vector<float> result;
  for (int y = 0; y < 57; ++y)
    for (int x = 0; x < 101; ++x) result.push_back(buffer.hidden_beyond(x, y));
  return result;
}

TEST(OcclusionBuffer, EveryTargetGivesTheBitsOfTheScalarLoops) {
  const std::vector<cases::Case> scenes = cases::generated();
  int targets = 0;
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().DeInit();
    ++targets;
    for (const cases::Case& c : scenes)
      for (const View& view : cases::hard_views(c.scene, 6, 3))
        EXPECT_EQ(pixels(c.scene, view, false), pixels(c.scene, view, true))
            << c.name << " on " << hwy::TargetName(target);
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().DeInit();
  EXPECT_GE(targets, 1);
  std::printf("%d SIMD targets compared\n", targets);
}

}  // namespace
}  // namespace sightline
