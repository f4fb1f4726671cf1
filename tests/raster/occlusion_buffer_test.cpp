// The occlusion buffer by itself: what it must hide, what it must never hide, and the same bits from every set of
// loops.
#include "sightline/raster/occlusion_buffer.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include "agreement/cases.hpp"
#include "sightline/parallel/parallel.hpp"

extern "C" int sightline_test_from_c();

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

TEST(OcclusionBuffer, ATallDiamondIsFilledFromTipToTip) {
  constexpr int size = 301;  // more rows of tiles than are cut at once
  const OccluderMesh diamond = occluder(cases::quad({-2, 0, -5}, {2, 2, 0}, {2, -2, 0}));
  const View view = front_view(size, size);
  const double reach = 2.0 / 5.0 * 0.5 * size / std::tan(0.5 * view.fov_y);  // pixels from the centre to a tip
  for (const bool scalar : {false, true}) {
    OcclusionBuffer buffer(scalar);
    buffer.begin(view, size, size);
    buffer.add_occluder(diamond, identity_affine());
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const double away = std::abs(x + 0.5 - 0.5 * size) + std::abs(y + 0.5 - 0.5 * size);
        const float hidden = buffer.hidden_beyond(x, y);
        if (away + 1.0 < reach - 0.1) {
          ASSERT_NEAR(hidden, 5.0f, 0.01f) << x << ", " << y;
        } else if (away + 1.0 > reach) {
          ASSERT_TRUE(std::isinf(hidden)) << x << ", " << y;
        }
      }
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

std::vector<OccluderMesh> occluders(const Scene& scene) {
  std::vector<OccluderMesh> meshes;
  for (const Mesh& mesh : scene.meshes()) meshes.push_back(occluder(mesh));
  return meshes;
}

std::vector<OccluderInstance> instances(const Scene& scene, const std::vector<OccluderMesh>& meshes) {
  std::vector<OccluderInstance> all;
  for (const Object& object : scene.objects()) all.push_back({&meshes[object.mesh], object.transform});
  return all;
}

std::vector<float> pixels(const OcclusionBuffer& buffer) {
  std::vector<float> result;
  for (int y = 0; y < buffer.height(); ++y)
    for (int x = 0; x < buffer.width(); ++x) result.push_back(buffer.hidden_beyond(x, y));
  return result;
}

/// All pixels of a buffer over a scene, and what it says of the objects' boxes.
std::vector<float> pixels(const Scene& scene, const View& view, bool scalar) {
  OcclusionBuffer buffer(scalar);
  buffer.begin(view, 101, 57);
  const std::vector<OccluderMesh> meshes = occluders(scene);
  for (const OccluderInstance& o : instances(scene, meshes)) buffer.add_occluder(*o.mesh, o.transform);
  const std::vector<Aabb> boxes = scene.object_bounds();
  std::vector<std::uint8_t> seen(boxes.size());
  buffer.test(boxes, seen);
  std::vector<float> result = pixels(buffer);
  result.insert(result.end(), seen.begin(), seen.end());
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

TEST(OcclusionBuffer, OrderAndThreadsChangeNoBit) {
  for (const cases::Case& c : cases::generated()) {
    const std::vector<OccluderMesh> meshes = occluders(c.scene);
    const std::vector<OccluderInstance> all = instances(c.scene, meshes);
    for (const View& view : cases::hard_views(c.scene, 8, 21)) {
      OcclusionBuffer backwards;
      backwards.begin(view, 131, 74);
      for (std::size_t i = all.size(); i-- > 0;) backwards.add_occluder(*all[i].mesh, all[i].transform);
      OcclusionCounts alone;
      for (const int threads : {1, 2, 5}) {
        const ThreadLimit limit(threads);
        OcclusionBuffer together;
        together.begin(view, 131, 74);
        together.add_occluders(all);
        EXPECT_EQ(pixels(together), pixels(backwards)) << c.name << ", " << threads << " threads: " << describe(view);
        const OcclusionCounts counts = together.counts();
        if (threads == 1) alone = counts;
        EXPECT_EQ(counts.occluders, alone.occluders) << c.name << ", " << threads << " threads: " << describe(view);
        EXPECT_EQ(counts.occluder_triangles, alone.occluder_triangles) << c.name << ", " << threads << " threads";
      }
    }
  }
}

TEST(OcclusionBuffer, RawTrianglesHideWhatTheirMeshHides) {
  for (const cases::Case& c : cases::generated()) {
    const std::vector<OccluderMesh> meshes = occluders(c.scene);
    for (const View& view : cases::hard_views(c.scene, 2, 5)) {
      OcclusionBuffer raw, made;
      raw.begin(view, 90, 51);
      made.begin(view, 90, 51);
      for (const Object& object : c.scene.objects()) {
        const Mesh& mesh = c.scene.meshes()[object.mesh];
        raw.add_occluder(mesh.positions, mesh.triangles, object.transform);
        made.add_occluder(meshes[object.mesh], object.transform);
      }
      const std::vector<float> a = pixels(raw), b = pixels(made);
      // Without welding there are more contours, unless welding joined what rounding had put in one place.
      if (c.name.starts_with("awkward") || c.name.starts_with("degenerate")) continue;
      for (std::size_t i = 0; i < a.size(); ++i) EXPECT_GE(a[i], b[i]) << c.name;
      if (c.name.starts_with("gap")) {
        EXPECT_EQ(a, b) << c.name;
      }
    }
  }
}

TEST(OcclusionBuffer, VerticesThatNoTriangleUsesChangeNothing) {
  constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  const Mesh wall = cases::quad({-20, -20, -5}, {40, 0, 0}, {0, 40, 0});
  for (const glm::vec3& unused : {glm::vec3(inf), glm::vec3(-inf, inf, 0), glm::vec3(nan), glm::vec3(0, nan, 0),
                                  glm::vec3(3e38f), glm::vec3(0, 0, 1e6f), glm::vec3(0)}) {
    std::vector<glm::vec3> shared(500, unused);
    shared.resize(1000, -unused);
    shared.insert(shared.begin() + 500, wall.positions.begin(), wall.positions.end());
    std::vector<glm::uvec3> triangles = wall.triangles;
    for (glm::uvec3& t : triangles) t += 500u;
    OcclusionBuffer own, among;
    own.begin(front_view(), 80, 45);
    among.begin(front_view(), 80, 45);
    own.add_occluder(wall.positions, wall.triangles, identity_affine());
    among.add_occluder(shared, triangles, identity_affine());
    EXPECT_FALSE(among.may_be_seen(box_at({0, 0, -8}, 1)));
    EXPECT_TRUE(among.may_be_seen(box_at({0, 0, -3}, 1)));
    EXPECT_EQ(pixels(among), pixels(own)) << unused.x << ' ' << unused.y << ' ' << unused.z;
    // Without triangles, behind the wall and beside the image: nothing is drawn.
    among.add_occluder(shared, {}, identity_affine());
    Affine away = identity_affine();
    away[3] = {0, 0, -5};
    among.add_occluder(shared, triangles, away);
    away[3] = {0, 100, 0};
    among.add_occluder(shared, triangles, away);
    EXPECT_EQ(among.counts().occluders, 1u);
  }
}

/// The truth about one point, from the buffer's own pixels: it lies before everything that its pixel hides.
bool point_is_seen(const OcclusionBuffer& buffer, const View& view, const glm::dvec3& point) {
  const glm::dvec4 clip = view_projection(view) * glm::dvec4(point, 1.0);
  const double distance = glm::dot(point - view.eye, view_direction(view));
  if (!(distance > view.near * 1.001) || !(clip.w > 0)) return false;
  const double x = (0.5 + 0.5 * clip.x / clip.w) * buffer.width();
  const double y = (0.5 - 0.5 * clip.y / clip.w) * buffer.height();
  if (!(x > 0.01 && y > 0.01 && x < buffer.width() - 0.01 && y < buffer.height() - 0.01)) return false;
  const double hidden = buffer.hidden_beyond(static_cast<int>(x), static_cast<int>(y));
  return distance < hidden - 1e-4 * std::abs(hidden);
}

TEST(OcclusionBuffer, NoOccludeeWithASeenPointIsCalledHidden) {
  Random random(77);
  std::size_t hidden[4] = {}, seen_points = 0;
  for (const cases::Case& c : cases::generated()) {
    const std::vector<OccluderMesh> meshes = occluders(c.scene);
    for (const View& view : cases::hard_views(c.scene, 12, 31)) {
      OcclusionBuffer buffer;
      buffer.begin(view, 61, 35);
      buffer.add_occluders(instances(c.scene, meshes));
      const double size = glm::length(c.scene.bounds().extent());
      for (int i = 0; i < 40; ++i) {
        const glm::vec3 at(cases::point_in(c.scene.bounds(), random));
        const auto extent = static_cast<float>(size * random.power_of_two_range(-10, -3));
        const glm::mat3 turn(glm::mat3_cast(glm::angleAxis(random.range(0, 6), random.direction())));
        const Aabb box{at - extent, at + glm::vec3(extent, 0.3f * extent, extent)};
        const OrientedBox oriented{{turn[0], turn[1] * 0.4f, turn[2], at}, {glm::vec3(-extent), glm::vec3(extent)}};
        const Sphere sphere{at, extent};
        const glm::vec3 triangle[3] = {at, at + turn[0] * extent, at + turn[1] * extent};
        const bool answers[4] = {buffer.may_be_seen(box), buffer.may_be_seen(oriented), buffer.may_be_seen(sphere),
                                 buffer.may_be_seen(triangle[0], triangle[1], triangle[2])};
        for (int kind = 0; kind < 4; ++kind) hidden[kind] += answers[kind] ? 0 : 1;
        for (int k = 0; k < 60; ++k) {
          const glm::dvec3 u(random.range(0, 1), random.range(0, 1), random.range(0, 1));
          const glm::dvec3 local = (u * 2.0 - 1.0) * static_cast<double>(extent);
          const glm::dvec3 points[4] = {glm::mix(glm::dvec3(box.lo), glm::dvec3(box.hi), u),
                                        glm::dvec3(to_matrix(oriented.transform) * glm::dvec4(local, 1.0)),
                                        glm::dvec3(at) + static_cast<double>(extent) * 0.9999 * random.direction(),
                                        glm::dvec3(triangle[0]) +
                                            glm::dvec3(triangle[1] - triangle[0]) * u.x * (1.0 - u.y) +
                                            glm::dvec3(triangle[2] - triangle[0]) * u.x * u.y};
          for (int kind = 0; kind < 4; ++kind) {
            if (answers[kind]) continue;
            const bool seen = point_is_seen(buffer, view, points[kind]);
            seen_points += seen ? 1 : 0;
            EXPECT_FALSE(seen) << c.name << ", kind " << kind << ", " << describe(view);
          }
        }
      }
    }
  }
  for (const std::size_t h : hidden) EXPECT_GT(h, 100u) << "the test asks for nothing";
  EXPECT_EQ(seen_points, 0u);
}

TEST(OcclusionBuffer, OutlinesFindMoreThanRectanglesAndBatchesTheSame) {
  const Scene scene = generate_scene("city", {.objects = 900, .triangles = 0, .seed = 2});
  const std::vector<OccluderMesh> meshes = occluders(scene);
  const std::vector<Aabb> boxes = scene.object_bounds();
  std::size_t by_outline = 0, by_rectangle = 0;
  for (const View& view : cases::hard_views(scene, 24, 4)) {
    OcclusionBuffer buffer;
    buffer.begin(view, 160, 90);
    buffer.add_occluders(instances(scene, meshes));
    std::vector<std::uint8_t> seen(boxes.size()), seen_by_rectangle(boxes.size());
    buffer.test(boxes, seen);
    buffer.test(boxes, seen_by_rectangle, false);
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      EXPECT_EQ(seen[i] != 0, buffer.may_be_seen(boxes[i]));
      EXPECT_EQ(seen_by_rectangle[i] != 0, buffer.may_be_seen_by_rectangle(boxes[i]));
      EXPECT_LE(seen[i], seen_by_rectangle[i]);
      by_outline += seen[i] == 0 ? 1 : 0;
      by_rectangle += seen_by_rectangle[i] == 0 ? 1 : 0;
    }
  }
  EXPECT_GT(by_outline, by_rectangle);
}

TEST(OcclusionBuffer, CentresAloneHideMoreThanSquares) {
  // A fence of boards with gaps that fall between the centres of the pixels: seen through, by squares; hidden by
  // centres.
  View view = front_view(64, 36);
  view.projection = Projection::orthographic;
  view.span_y = 36;
  const OccluderMesh board = occluder(cases::quad({-0.45f, -20, -5}, {0.9f, 0, 0}, {0, 40, 0}));
  for (const Coverage coverage : {Coverage::squares, Coverage::centres}) {
    OcclusionBuffer buffer;
    buffer.begin(view, 64, 36, coverage);
    for (int i = -40; i < 40; ++i) buffer.add_occluder(board, cases::at({static_cast<float>(i) + 0.5f, 0, 0}));
    EXPECT_EQ(buffer.may_be_seen(box_at({0, 0, -9}, 3)), coverage == Coverage::squares);
  }
}

TEST(OcclusionBuffer, CentresOfAFinerBufferAreAGridOfSamples) {
  // The gaps of the same fence are a tenth of a pixel wide and lie between pixels: none of 4 x 4 samples falls into
  // one, some of 16 x 16 do.
  View view = front_view(64, 36);
  view.projection = Projection::orthographic;
  view.span_y = 36;
  const OccluderMesh board = occluder(cases::quad({-0.45f, -20, -5}, {0.9f, 0, 0}, {0, 40, 0}));
  for (const int samples : {4, 16}) {
    OcclusionBuffer buffer;
    buffer.begin(view, samples * 64, samples * 36, Coverage::centres);
    for (int i = -40; i < 40; ++i) buffer.add_occluder(board, cases::at({static_cast<float>(i) + 0.5f, 0, 0}));
    EXPECT_EQ(buffer.may_be_seen(box_at({0, 0, -9}, 3)), samples == 16);
  }
}

TEST(OcclusionBuffer, EmptyAndBrokenOccludees) {
  OcclusionBuffer buffer;
  buffer.begin(front_view(), 80, 45);
  buffer.add_occluders({});
  buffer.add_occluder(std::span<const glm::vec3>(), std::span<const glm::uvec3>(), identity_affine());
  EXPECT_FALSE(buffer.may_be_seen(Aabb()));
  EXPECT_FALSE(buffer.may_be_seen(OrientedBox()));
  EXPECT_FALSE(buffer.may_be_seen(Sphere{{0, 0, -5}, -1.0f}));
  EXPECT_TRUE(
      buffer.may_be_seen(OrientedBox{{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, -5}}, {{-1, -1, -1}, {1, 1, 1}}}));
  EXPECT_TRUE(buffer.may_be_seen(Sphere{{0, 0, 0}, 1.0f})) << "around the eye";
}

TEST(OcclusionBuffer, IsReachedFromC) { EXPECT_EQ(sightline_test_from_c(), 0) << "line of occlusion_buffer_c.c"; }

}  // namespace
}  // namespace sightline
