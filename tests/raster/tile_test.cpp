// The fast rasteriser against the readable one, its determinism, and the depth tiles (checklist 5, 6).
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cmath>
#include <numeric>

#include "agreement/cases.hpp"
#include "raster/pipeline_fixture.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/raster/scene_draw.hpp"
#include "sightline/raster/tile_memory.hpp"
#include "sightline/raster/tile_rasteriser.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/generate/raster_scenes.hpp"

namespace sightline::raster {
namespace {

std::vector<ObjectId> all_objects(const Scene& scene) {
  std::vector<ObjectId> ids(scene.objects().size());
  std::iota(ids.begin(), ids.end(), ObjectId{0});
  return ids;
}

bool same(const Frame& a, const Frame& b) {
  return a.depth == b.depth && a.object == b.object && a.triangle == b.triangle;
}

// Rule 8: the same bits for every number of threads and every SIMD target, and for the hierarchical one.
TEST(TileRasteriser, SameImageForThreadsTargetsAndHierarchy) {
  for (const char* kind : {"soup", "city", "plant"}) {
    const Scene scene = generate_scene(kind, {.objects = 300, .triangles = 0, .seed = 5});
    const TileRasteriser rasteriser(scene);
    for (View view : cases::hard_views(scene, 16, 3, 320)) {
      Frame reference, other;
      TileStats reference_stats;
      rasteriser.draw(view, all_objects(scene), {.scalar = true}, reference, reference_stats);
      const auto supported = hwy::SupportedTargets();
      for (const int threads : {1, 2, 5})
        for (const bool hierarchical : {false, true}) {
          const ThreadLimit limit(threads);
          TileStats stats;
          rasteriser.draw(view, all_objects(scene), {.hierarchical = hierarchical}, other, stats);
          ASSERT_TRUE(same(reference, other)) << kind << " " << threads << " threads, " << describe(view);
          if (!hierarchical) {
            EXPECT_EQ(stats.work.written, reference_stats.work.written);
            EXPECT_EQ(stats.work.tested, reference_stats.work.tested);
          }
        }
      hwy::SetSupportedTargetsForTest(0);
      for (std::int64_t targets = static_cast<std::int64_t>(supported); targets != 0; targets &= targets - 1) {
        hwy::SetSupportedTargetsForTest(targets & -targets);
        TileStats stats;
        rasteriser.draw(view, all_objects(scene), {.hierarchical = true}, other, stats);
        ASSERT_TRUE(same(reference, other)) << hwy::TargetName(targets & -targets);
      }
      hwy::SetSupportedTargetsForTest(0);
      // Depth alone is the same depth; order of the objects does not matter.
      std::vector<ObjectId> reversed = all_objects(scene);
      std::reverse(reversed.begin(), reversed.end());
      for (const bool hierarchical : {false, true}) {
        TileStats stats;
        rasteriser.draw(view, reversed, {.ids = false, .hierarchical = hierarchical}, other, stats);
        ASSERT_EQ(other.depth, reference.depth);
        rasteriser.draw(view, reversed, {.hierarchical = hierarchical}, other, stats);
        ASSERT_TRUE(same(reference, other)) << "reversed order";
      }
    }
  }
}

// Watertight: a closed mesh around the eye covers every pixel, through near plane, guard band and clipping.
TEST(TileRasteriser, ClosedMeshAroundTheEyeHasNoHoles) {
  Random random(6);
  for (int round = 0; round < 60; ++round) {
    SceneBuilder builder;
    Mesh mesh;
    const int sides = 5 + static_cast<int>(random.below(60)), rings = 3 + static_cast<int>(random.below(40));
    for (int j = 0; j <= rings; ++j)
      for (int i = 0; i < sides; ++i) {
        const double a = 6.283185307179586 * i / sides, b = 3.141592653589793 * j / rings;
        const double r = round % 2 == 0 ? 2.0 : random.range(0.5, 20.0);
        mesh.positions.emplace_back(r * std::sin(b) * std::cos(a), r * std::cos(b), r * std::sin(b) * std::sin(a));
      }
    for (int i = 1; i < sides; ++i) {  // poles are one point each
      mesh.positions[static_cast<std::size_t>(i)] = mesh.positions[0];
      mesh.positions[static_cast<std::size_t>(rings * sides + i)] =
          mesh.positions[static_cast<std::size_t>(rings * sides)];
    }
    const auto v = [&](int i, int j) { return static_cast<std::uint32_t>(j * sides + i % sides); };
    for (int j = 0; j < rings; ++j)
      for (int i = 0; i < sides; ++i) {
        mesh.triangles.push_back({v(i, j), v(i + 1, j), v(i + 1, j + 1)});
        mesh.triangles.push_back({v(i, j), v(i + 1, j + 1), v(i, j + 1)});
      }
    const MeshId id = builder.add_mesh(mesh);
    builder.add_object(id, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {100.3f, -50.7f, 3.1f}});
    const Scene scene = builder.build();
    View view = look_along(glm::dvec3(100.3, -50.7, 3.1) + 0.2 * random.direction(), random.direction());
    view.width = 300 + static_cast<int>(random.below(200));
    view.height = 150 + static_cast<int>(random.below(100));
    view.fov_y = random.range(0.3, 2.8);
    view.near = 1e-4;
    const TileRasteriser rasteriser(scene);
    for (const bool hierarchical : {false, true}) {
      Frame frame;
      TileStats stats;
      rasteriser.draw(view, all_objects(scene), {.hierarchical = hierarchical}, frame, stats);
      const auto holes = std::count(frame.object.begin(), frame.object.end(), no_object);
      EXPECT_EQ(holes, 0) << "round " << round << " " << describe(view);
    }
  }
}

// 5.01-5.04: layers one behind the other: the hierarchy rejects tiles, the image is the same, overdraw is 1.
TEST(TileRasteriser, HierarchyLeavesNoOverdrawOfLayers) {
  const SceneAndView task = full_screen_layers(40);
  const TileRasteriser rasteriser(task.scene);
  Frame plain, hierarchical;
  TileStats plain_stats, stats;
  rasteriser.draw(task.view, all_objects(task.scene), {.count_writes = true}, plain, plain_stats);
  rasteriser.draw(task.view, all_objects(task.scene), {.hierarchical = true, .count_writes = true}, hierarchical,
                  stats);
  EXPECT_TRUE(same(plain, hierarchical));
  const std::uint64_t pixels = plain.depth.size();
  EXPECT_EQ(plain_stats.work.written, 40 * pixels);  // object 0 is the farthest
  EXPECT_EQ(stats.work.written, pixels);
  EXPECT_EQ(std::accumulate(stats.writes.begin(), stats.writes.end(), std::uint64_t{0}), pixels);
  EXPECT_GT(stats.objects_hidden, stats.objects / 2);
}

// 5.03: a triangle before another: the tiles that it hides wholly are left out of the second one.
TEST(TileRasteriser, HiddenTilesOfALargeTriangleAreLeftOut) {
  SceneBuilder builder;
  Mesh two{"two",
           {{-9, -9, -5}, {9, -9, -5}, {0, 9, -5}, {-9, -9, -8}, {9, -9, -8}, {0, 9, -8}},
           {{0, 1, 2}, {3, 4, 5}},
           false,
           {}};
  const MeshId mesh = builder.add_mesh(two);
  builder.add_object(mesh, identity_affine());
  const Scene scene = builder.build();
  const TileRasteriser rasteriser(scene);
  Frame frame;
  TileStats stats;
  rasteriser.draw(look_along({0, 0, 0}, {0, 0, -1}), all_objects(scene), {.hierarchical = true}, frame, stats);
  EXPECT_GT(stats.work.tiles_rejected, 3000u);
  EXPECT_EQ(std::count_if(frame.triangle.begin(), frame.triangle.end(), [](std::uint32_t t) { return t == 1; }), 0);
}

// 5.12 in the fast path: a tile that a triangle's plane could reach but none of its fragments does stays as it is.
TEST(TileRasteriser, TilesWithoutANearerFragmentStayAsTheyAre) {
  SceneBuilder builder;
  Mesh mesh{"wall and tilted triangles",
            {{-9, -9, -5}, {9, -9, -5}, {9, 9, -5}, {-9, 9, -5}},
            {{0, 1, 2}, {0, 2, 3}},
            false,
            {}};
  Random random(33);
  for (std::uint32_t i = 0; i < 20; ++i) {  // through the wall, so that some tiles are cut where the plane is before it
    for (int k = 0; k < 3; ++k)
      mesh.positions.emplace_back(random.range(-3, 3), random.range(-3, 3), k == 0 ? -4.5 : random.range(-9, -5.2));
    mesh.triangles.push_back({4 + 3 * i, 5 + 3 * i, 6 + 3 * i});
  }
  const MeshId id = builder.add_mesh(mesh);
  builder.add_object(id, identity_affine());
  const Scene scene = builder.build();
  const TileRasteriser rasteriser(scene);
  const View view = look_along({0, 0, 0}, {0, 0, -1});
  for (const bool scalar : {false, true}) {
    Frame plain, hierarchical;
    TileStats plain_stats, stats;
    rasteriser.draw(view, all_objects(scene), {.scalar = scalar}, plain, plain_stats);
    rasteriser.draw(view, all_objects(scene), {.hierarchical = true, .scalar = scalar}, hierarchical, stats);
    EXPECT_TRUE(same(plain, hierarchical));
    EXPECT_GT(stats.work.tiles_unchanged, 50u);
    EXPECT_LT(stats.work.tiles_unchanged, stats.work.tiles_filled);
    EXPECT_EQ(plain_stats.work.tiles_unchanged, 0u);
  }
}

/// The window positions of a scene's triangles that lie wholly within the view.
std::vector<std::array<WindowPoint, 3>> window_triangles(const Scene& scene, const View& view) {
  std::vector<std::array<WindowPoint, 3>> out;
  const glm::dmat4 to_clip = view_projection(view);
  for (const Object& object : scene.objects())
    for (const glm::uvec3& t : scene.meshes()[object.mesh].triangles) {
      std::array<WindowPoint, 3> w{};
      bool inside = true;
      for (int k = 0; k < 3; ++k) {
        const glm::vec4 clip(
            to_clip * glm::dvec4(transform_point(object.transform, scene.meshes()[object.mesh].positions[t[k]]), 1.0));
        inside = inside && clip.w > 0 && std::abs(clip.z) <= clip.w && std::abs(clip.x) < 4 * clip.w &&
                 std::abs(clip.y) < 4 * clip.w;
        if (inside) w[static_cast<std::size_t>(k)] = viewport_transform(clip, view.width, view.height);
      }
      if (inside) out.push_back(w);
    }
  return out;
}

// 5.06-5.13: every combination of features gives the image of the plain z-buffer; each saves traffic.
TEST(TileMemory, ImageIsThatOfThePlainZBufferAndFeaturesSaveTraffic) {
  const Scene scene = generate_scene("soup", {.objects = 200, .triangles = 0, .seed = 3});
  View view = look_along(glm::dvec3(scene.bounds().centre()) +
                             glm::dvec3(0, 0, 1.2 * static_cast<double>(glm::length(scene.bounds().extent()))),
                         {0, 0, -1});
  view.width = 203;
  view.height = 117;
  view.far = 1e3;
  const auto triangles = window_triangles(scene, view);
  std::vector<std::uint32_t> plain(static_cast<std::size_t>(view.width * view.height), 0xFFFFFF);
  for (const auto& w : triangles) {
    TriangleSetup t;
    if (!set_up(w, view.width, view.height, true, t)) continue;
    const Plane3 z = plane_through(t, w[0].z, w[1].z, w[2].z);
    each_pixel(t, t.x0, t.y0, t.x1 - t.x0, t.y1 - t.y0, TileCover::part, [&](int x, int y) {
      auto& stored = plain[static_cast<std::size_t>(y * view.width + x)];
      stored = std::min(stored, depth_code(DepthFormat::unorm24, z.at(x, y)));
    });
  }
  std::uint64_t total[8];
  for (int bits = 0; bits < 8; ++bits) {
    TileMemory memory(view.width, view.height, {(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0});
    for (const auto& w : triangles) memory.draw(w);
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; ++x) {
        const DepthTile tile = memory.tile(y / 8 * memory.across() + x / 8);
        ASSERT_EQ(tile[static_cast<std::size_t>(y % 8 * 8 + x % 8)],
                  plain[static_cast<std::size_t>(y * view.width + x)])
            << bits;
      }
    total[bits] = memory.traffic().total();
    const TileTraffic& traffic = memory.traffic();
    if ((bits & 2) != 0) {
      EXPECT_GT(traffic.rejected[0] + traffic.rejected[1] + traffic.rejected[2], 0u);
    }
    EXPECT_LE(traffic.fetches + traffic.rejected[0] + traffic.rejected[1] + traffic.rejected[2], traffic.visits);
    if ((bits & 1) != 0) {
      EXPECT_EQ(traffic.cleared, 0u);
    }
  }
  for (int bits = 0; bits < 8; ++bits)
    for (const int feature : {1, 2, 4})
      if ((bits & feature) == 0) {
        EXPECT_LT(total[bits | feature], total[bits]) << bits << " + " << feature;
      }
}

// 6.01-6.07, E9: the definitions count different things, and overdraw depends on the order.
TEST(DepthComplexity, DefinitionsAndOrders) {
  Target target(16, 16);
  const int layers = 6;
  const auto draw_order = [&](bool front_first) {
    target.clear();
    target.count_pixels();
    for (int i = 0; i < layers; ++i)
      draw_window(State(), screen(target, 0.1f + 0.1f * static_cast<float>(front_first ? i : layers - 1 - i)),
                  {1, 1, 1, 1}, target);
  };
  draw_order(true);
  EXPECT_EQ(target.counts.fragments[5], 6u);
  EXPECT_EQ(target.counts.depth_tests[5], 6u);
  EXPECT_EQ(target.counts.colour_writes[5], 1u);
  draw_order(false);
  EXPECT_EQ(target.counts.colour_writes[5], 6u);
  EXPECT_EQ(target.counts.depth_writes[5], 6u);
  // Back-face culling changes the number of tests, not that of the layers of the scene (def. e against a to c).
  State culled;
  culled.cull = CullFace::front;
  target.clear();
  target.count_pixels();
  draw_window(culled, screen(target, 0.5f), {1, 1, 1, 1}, target);
  EXPECT_EQ(target.counts.depth_tests[5], 0u);
}

// 6.06: the same layers are six one behind the other or, seen from the side, one.
TEST(DepthComplexity, DependsOnViewpointAndDirection) {
  SceneBuilder builder;
  const MeshId plate =
      builder.add_mesh({"plate", {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}, false, {}});
  for (int i = 0; i < 6; ++i) builder.add_object(plate, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {3.0f * i, 0, -3.0f * i}});
  const Scene scene = builder.build();
  const auto largest = [&](const View& view) {
    Target target(view.width, view.height);
    target.count_pixels();
    SceneDraw untested;
    untested.state.depth.enabled = false;
    DrawCounts counts;
    draw_scene(scene, view, all_objects(scene), untested, target, counts);
    return *std::max_element(target.counts.fragments.begin(), target.counts.fragments.end());
  };
  View view = look_along({-6, 0, 6}, {1, 0, -1});
  view.width = view.height = 120;
  EXPECT_EQ(largest(view), 6u);
  view = look_along({7.5f, 0, 20}, {0, 0, -1});
  view.width = view.height = 120;
  EXPECT_EQ(largest(view), 1u);
}

// 4.10: a depth pre-pass with the hierarchy leaves the same depth and draws fewer triangles by a third at least.
TEST(TileRasteriser, TheHierarchyMakesADepthPrePassCheap) {
  const SceneAndView task = instanced_spheres(6);
  const Scene& scene = task.scene;
  const TileRasteriser rasteriser(scene);
  const View& view = task.view;
  Frame plain, hierarchical;
  TileStats plain_stats, stats;
  rasteriser.draw(view, all_objects(scene), {.ids = false}, plain, plain_stats);
  rasteriser.draw(view, all_objects(scene), {.ids = false, .hierarchical = true}, hierarchical, stats);
  EXPECT_EQ(plain.depth, hierarchical.depth);
  EXPECT_TRUE(plain.object.empty());
  EXPECT_LT(3 * stats.triangles_in, 2 * plain_stats.triangles_in);
}

// 6.08, E10: in random order the expected number of colour writes is H_n, not ln n + 0.5.
TEST(DepthComplexity, RandomOrderWritesTheHarmonicNumber) {
  Random random(12);
  for (const int n : {1, 2, 4, 16}) {
    double harmonic = 0, sum = 0;
    for (int i = 1; i <= n; ++i) harmonic += 1.0 / i;
    constexpr int rounds = 6000;
    for (int round = 0; round < rounds; ++round) {
      double nearest = 2;
      for (int i = 0; i < n; ++i) {
        const double z = random.uniform();
        sum += z < nearest ? 1 : 0;
        nearest = std::min(nearest, z);
      }
    }
    EXPECT_NEAR(sum / rounds, harmonic, 0.06) << n;
    if (n <= 4) {
      EXPECT_GT(std::abs(sum / rounds - (std::log(n) + 0.5)) / (sum / rounds), 0.05);
    }
  }
}

}  // namespace
}  // namespace sightline::raster
