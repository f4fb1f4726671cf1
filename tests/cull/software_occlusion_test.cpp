// The occlusion cullers by their own examples: the effect of the order (checklist 21.16, 21.17), thresholds and lost
// pixels (21.07), batches (22.12), a tetrahedron behind other objects (21.04).
#include <gtest/gtest.h>

#include "agreement/answer.hpp"
#include "agreement/cases.hpp"
#include "sightline/cull/occlusion_map.hpp"
#include "sightline/oracle/oracle.hpp"
#include "sightline/scene/generate/shapes.hpp"
#include "sightline/scene/input_error.hpp"

namespace sightline {
namespace {

constexpr Promise row = Promise::conservative_continuous;

Verdict verdict_of(const Answer& answer, const Scene& scene, const View& view) {
  return judge(Oracle(scene).look(view), answer.visible);
}

View small_view(const glm::dvec3& eye, const glm::dvec3& direction) {
  View view = look_along(eye, direction);
  view.width = 320;
  view.height = 180;
  return view;
}

View front_view() { return small_view({0, 0, 0}, {0, 0, -1}); }

/// From the middle of a city's ground.
View street_view(const Scene& scene) {
  return small_view({scene.bounds().centre().x, 1.7, scene.bounds().centre().z}, {1, 0, 0.3});
}

const char* const conservative[] = {"occlusion_hzb", "occlusion_hom", "occlusion_map", "occlusion_masked"};

/// `count` walls one behind the other, each of which hides all behind it.
Scene walls_in_a_row(int count) {
  SceneBuilder builder;
  const MeshId wall = builder.add_mesh(cases::quad({-50, -50, 0}, {100, 0, 0}, {0, 100, 0}));
  for (int i = 0; i < count; ++i) builder.add_object(wall, cases::at({0, 0, -5.0f - static_cast<float>(i)}));
  return builder.build();
}

// 21.16: 1-2-3-4 draws one of four walls, 4-3-2-1 draws all four.
TEST(OcclusionOrder, BestAndWorstCase) {
  const Scene scene = walls_in_a_row(4);
  const IndexedScene indexed = index_scene(scene);
  for (const char* method : {"occlusion_hzb", "occlusion_map", "occlusion_virtual"}) {
    EXPECT_EQ(ask(method, indexed, front_view()).visible.count(), 1u) << method;
    EXPECT_EQ(ask(std::string(method) + ":order=worst", indexed, front_view()).visible.count(), 4u) << method;
  }
}

// 21.17: the culling rate falls from sorted over random to worst, and no order loses anything.
TEST(OcclusionOrder, CullingRateFallsFromSortedOverRandomToWorst) {
  const Scene scene = generate_scene("city", {.objects = 1500, .triangles = 0, .seed = 3});
  const IndexedScene indexed = index_scene(scene);
  const View view = street_view(scene);
  for (const char* method : {"occlusion_hzb", "occlusion_map"}) {
    const Answer sorted = ask(std::string(method) + ":order=sorted", indexed, view);
    const Answer random = ask(std::string(method) + ":order=random", indexed, view);
    const Answer worst = ask(std::string(method) + ":order=worst", indexed, view);
    EXPECT_LT(sorted.visible.count(), random.visible.count()) << method;
    EXPECT_LT(random.visible.count(), worst.visible.count()) << method;
    for (const Answer* answer : {&sorted, &random, &worst})
      EXPECT_TRUE(verdict_of(*answer, scene, view).missed.empty()) << method;
  }
}

// 21.04: a tetrahedron behind grey objects that cover it together but not alone.
TEST(Occlusion, ATetrahedronBehindTwoObjects) {
  SceneBuilder builder;
  const MeshId half = builder.add_mesh(cases::quad({0, -5, 0}, {6, 0, 0}, {0, 10, 0}));
  Mesh tetrahedron{"tetrahedron",
                   {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {0, 0, 1}},
                   {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}},
                   false,
                   {}};
  builder.add_object(half, cases::at({-1, 0, -4}), "right");
  builder.add_object(half, cases::at({-7, 0, -5}), "left, overlaps on the screen");
  const ObjectId hidden = builder.add_object(builder.add_mesh(tetrahedron), cases::at({-2.7f, 0, -12}));
  const Scene scene = builder.build();
  const IndexedScene indexed = index_scene(scene);
  for (const char* method : conservative)
    EXPECT_FALSE(ask(method, indexed, front_view()).visible.contains(hidden)) << method;
  // Nearer, it pokes out in front of the left one.
  SceneBuilder near;
  const MeshId again = near.add_mesh(cases::quad({0, -5, 0}, {6, 0, 0}, {0, 10, 0}));
  near.add_object(again, cases::at({-7.5f, 0, -5}));
  const ObjectId seen = near.add_object(near.add_mesh(tetrahedron), cases::at({-1.2f, 0, -5.5f}));
  const Scene poking = near.build();
  const IndexedScene poking_index = index_scene(poking);
  for (const char* method : conservative)
    EXPECT_TRUE(ask(method, poking_index, front_view()).visible.contains(seen)) << method;
}

// 24.01-24.05: a bend whose arms are hidden by a low and a tall wall; the box around both is not.
TEST(Occlusion, TightBoundsHideWhatOneBoxDoesNot) {
  SceneBuilder builder;
  const auto add = [&](const glm::vec3& low, const glm::vec3& high) {
    return builder.add_object(builder.add_mesh(make_box(low, high)), identity_affine());
  };
  add({-6, 0, -10}, {6, 1.5f, -9.5f});
  add({0.5f, 0, -9}, {3, 9, -8.5f});
  Mesh bend = make_box({-4, 0, -20}, {3, 1, -19});
  append(bend, make_box({3, 0, -20}, {4, 8, -19}));
  const ObjectId hidden = builder.add_object(builder.add_mesh(std::move(bend)), identity_affine());
  const Scene scene = builder.build();
  const IndexedScene indexed = index_scene(scene);
  const View view = small_view({0, 1, 0}, {0, 0.1, -1});
  ASSERT_FALSE(Oracle(scene).look(view).seen.contains(hidden));
  for (const char* method : {"occlusion_masked", "occlusion_horizon", "occlusion_hzb", "occlusion_hom", "occlusion_map",
                             "occlusion_virtual"}) {
    EXPECT_TRUE(ask(method, indexed, view).visible.contains(hidden)) << method;
    const Answer tight = ask(std::string(method) + ":tight=1.4", indexed, view);
    EXPECT_FALSE(tight.visible.contains(hidden)) << method;
    EXPECT_TRUE(verdict_of(tight, scene, view).missed.empty()) << method;
  }
}

// 21.07: what is seen through few pixels is dropped from a threshold on, and the loss stays below it.
TEST(Occlusion, AThresholdInPixelsLosesWhatIsBarelyVisible) {
  SceneBuilder builder;
  const MeshId wall = builder.add_mesh(cases::quad({-50, -50, -5}, {50, 0, 0}, {0, 100, 0}));
  const MeshId cube = builder.add_mesh(cases::cube(1));
  builder.add_object(wall, identity_affine());
  const ObjectId peeping = builder.add_object(cube, cases::at({-0.9f, 0, -20}));  // 0.1 m show: 3 pixels of 31
  const Scene scene = builder.build();
  const IndexedScene indexed = index_scene(scene);
  const std::uint32_t pixels = Oracle(scene).look(front_view()).samples[peeping];
  ASSERT_GT(pixels, 5u);
  EXPECT_TRUE(ask("occlusion_hzb:resolution=1", indexed, front_view()).visible.contains(peeping));
  EXPECT_TRUE(ask("occlusion_hzb:resolution=1:pixels=2", indexed, front_view()).visible.contains(peeping));
  const Answer rough = ask("occlusion_hzb:resolution=1:pixels=200", indexed, front_view());
  EXPECT_FALSE(rough.visible.contains(peeping));
  const Verdict verdict = verdict_of(rough, scene, front_view());
  EXPECT_EQ(verdict.missed_samples, pixels);
  EXPECT_LE(verdict.missed_samples, 200u);
  EXPECT_EQ(make_culler("occlusion_hzb:pixels=200", indexed)->promise(row), Promise::approximate);
  EXPECT_EQ(make_culler("occlusion_hzb", indexed)->promise(row), row);
  EXPECT_EQ(make_culler("occlusion_masked", indexed)->promise(row), row);
  EXPECT_EQ(make_culler("occlusion_masked:resolution=1:centres=on", indexed)->promise(row), Promise::conservative);
  EXPECT_EQ(make_culler("occlusion_virtual", indexed)->promise(Promise::approximate), Promise::approximate);
  EXPECT_EQ(make_culler("occlusion_virtual:step=1", indexed)->promise(Promise::approximate), Promise::conservative);
  EXPECT_THROW(make_culler("occlusion_virtual:resolution=0.5", indexed), InputError);
}

// Zhang's aggressive culling: a wall of bars with small gaps counts as opaque from an opacity on. The budget is for the
// bars alone; what is hidden would otherwise be an occluder too, and deepen the estimate in the gaps.
TEST(Occlusion, AnOpacityThresholdClosesSmallGaps) {
  SceneBuilder builder;
  const MeshId bar = builder.add_mesh(cases::quad({0, -50, -5}, {0.9f, 0, 0}, {0, 100, 0}));
  for (int i = -40; i < 40; ++i) builder.add_object(bar, cases::at({static_cast<float>(i), 0, 0}));
  const ObjectId behind = builder.add_object(builder.add_mesh(cases::cube(2)), cases::at({0, 0, -20}));
  const Scene scene = builder.build();
  const IndexedScene indexed = index_scene(scene);
  EXPECT_TRUE(ask("occlusion_hom:min_size=0:triangles=30", indexed, front_view()).visible.contains(behind));
  const Answer rough = ask("occlusion_hom:min_size=0:triangles=30:opacity=0.5", indexed, front_view());
  EXPECT_FALSE(rough.visible.contains(behind));
  EXPECT_GT(verdict_of(rough, scene, front_view()).missed_samples, 0u) << "the loss is counted in pixels";
  EXPECT_EQ(make_culler("occlusion_hom:opacity=0.9", indexed)->promise(row), Promise::approximate);
}

// Indoors the walls around the eye are one object that reaches before the near plane: large, but its box says nothing
// about depth. The drawn depth does (Zhang 1998).
TEST(Occlusion, WallsAroundTheEyeHideWhatStandsOutside) {
  Mesh walls;
  const glm::vec3 corners[] = {{-5, -9, -5}, {5, -9, -5}, {5, -9, 5}, {-5, -9, 5}};
  for (int i = 0; i < 4; ++i) {
    const auto first = static_cast<std::uint32_t>(walls.positions.size());
    const Mesh wall = cases::quad(corners[i], corners[(i + 1) % 4] - corners[i], {0, 18, 0});
    walls.positions.insert(walls.positions.end(), wall.positions.begin(), wall.positions.end());
    for (const glm::uvec3& t : wall.triangles) walls.triangles.push_back(t + first);
  }
  SceneBuilder builder;
  builder.add_object(builder.add_mesh(walls), identity_affine());
  const MeshId cube = builder.add_mesh(cases::cube(1));
  const ObjectId outside = builder.add_object(cube, cases::at({0, 0, -20})),
                 inside = builder.add_object(cube, cases::at({1, 0, -3}));
  const Scene scene = builder.build();
  const IndexedScene indexed = index_scene(scene);
  const Answer drawn = ask("occlusion_hom", indexed, front_view());
  EXPECT_FALSE(drawn.visible.contains(outside));
  EXPECT_TRUE(drawn.visible.contains(inside));
  EXPECT_TRUE(ask("occlusion_hom:depth=boxes", indexed, front_view()).visible.contains(outside));
  EXPECT_THROW(make_culler("occlusion_hom:depth=guessed", indexed), InputError);
}

// Bartz 1999: sparse samples lose what shows between them; with every sample taken nothing is lost.
TEST(Occlusion, SparseSamplesLoseWhatShowsBetweenThem) {
  SceneBuilder builder;
  const MeshId wall = builder.add_mesh(cases::quad({0, -50, -5}, {50, 0, 0}, {0, 100, 0}));
  builder.add_object(wall, cases::at({0.4f, 0, 0}));
  builder.add_object(wall, cases::at({-49.7f, 0, 0}));  // three pixels between them, columns 169 to 172
  builder.add_object(builder.add_mesh(cases::cube(2)), cases::at({0, 0, -20}));
  const Scene scene = builder.build();
  const IndexedScene indexed = index_scene(scene);
  const View view = front_view();
  const Answer dense = ask("occlusion_virtual:step=1", indexed, view),
               sparse = ask("occlusion_virtual:step=16", indexed, view);
  EXPECT_TRUE(verdict_of(dense, scene, view).missed.empty());
  EXPECT_FALSE(verdict_of(sparse, scene, view).missed.empty());
  EXPECT_GT(verdict_of(sparse, scene, view).missed_samples, 0u);
  EXPECT_LT(sparse.counters.cells_tested, dense.counters.cells_tested);
}

BoxFootprint rectangle(int x0, int y0, int x1, int y1) { return {BoxPlace::rectangle, x0, y0, x1, y1, 1, 2}; }

// 22.12: objects 1 to 5, front to back. 1, 2 and 3 stand apart and are asked at once; 4 overlaps 1 and waits for it.
TEST(OcclusionMap, TheSlidesFiveObjects) {
  const BoxFootprint objects[] = {rectangle(0, 0, 40, 40), rectangle(100, 0, 140, 40), rectangle(200, 0, 240, 40),
                                  rectangle(20, 20, 60, 60), rectangle(300, 0, 340, 40)};
  EXPECT_EQ(overlap_free_batches(objects, 80), (std::vector<std::uint32_t>{0, 0, 0, 1, 0}));
  EXPECT_EQ(overlap_free_batches(objects, 2), (std::vector<std::uint32_t>{0, 0, 1, 1, 2}));
  EXPECT_TRUE(overlap_free_batches({}, 80).empty());
}

// The same in space: a wall in front of the left. First batch the wall; second batch what stands before it and may be
// hidden (4); what stands where nothing was drawn (2, 3, 5) gets no query.
TEST(OcclusionMap, NoQueryWhereNothingWasDrawn) {
  SceneBuilder builder;
  const MeshId wall = builder.add_mesh(cases::quad({-1.5f, -1, 0}, {3, 0, 0}, {0, 2, 0}));
  const MeshId small = builder.add_mesh(cases::cube(0.4f));
  builder.add_object(wall, cases::at({-3, 0, -6}), "1");
  builder.add_object(small, cases::at({1, 0, -7}), "2");
  builder.add_object(small, cases::at({3.5f, 0, -7}), "3");
  const ObjectId hidden = builder.add_object(small, cases::at({-4.5f, 0, -9}), "4");
  builder.add_object(small, cases::at({7, 0, -12}), "5");
  const Scene scene = builder.build();
  const IndexedScene indexed = index_scene(scene);
  const Answer with = ask("occlusion_map", indexed, front_view()),
               without = ask("occlusion_map:map=off", indexed, front_view());
  EXPECT_FALSE(with.visible.contains(hidden));
  EXPECT_EQ(with.visible.count(), 4u);
  EXPECT_EQ(with.counters.queries, 1u);
  EXPECT_EQ(with.counters.queries_saved, 4u);
  EXPECT_EQ(without.counters.queries, 5u);
  EXPECT_EQ(without.counters.query_batches, 2u);
  EXPECT_EQ(with.visible.sorted(), without.visible.sorted());
}

// Batches never change an answer for the worse: what one of a batch draws could not have hidden another of it.
TEST(OcclusionMap, BatchesFindWhatOneByOneFinds) {
  const Scene scene = generate_scene("building", {.objects = 500, .triangles = 0, .seed = 6});
  const IndexedScene indexed = index_scene(scene);
  for (const View& view : cases::hard_views(scene, 16, 3)) {
    const Answer batches = ask("occlusion_map:batch=80", indexed, view),
                 singles = ask("occlusion_map:batch=1", indexed, view);
    EXPECT_LE(batches.visible.count(), singles.visible.count() + singles.visible.count() / 20);
    EXPECT_LE(batches.counters.query_batches, singles.counters.query_batches);
  }
}

// 21.03 on a city: bounding boxes taken for solid (the slides' shortcut) lose things, proven walls do not.
TEST(OcclusionHorizon, WallsLoseNothingBoxesDo) {
  SceneBuilder builder;
  Mesh slanted = cases::cube(1);  // a pyramid: its box hides far more than itself
  for (std::size_t i : {2u, 3u, 6u, 7u}) slanted.positions[i].x = slanted.positions[i].z = 0;
  builder.add_object(builder.add_mesh(slanted), {{4, 0, 0}, {0, 4, 0}, {0, 0, 4}, {0, 4, -14}});
  const ObjectId seen = builder.add_object(builder.add_mesh(cases::cube(0.5f)), cases::at({-4, 6, -24}));
  const Scene scene = builder.build();
  const IndexedScene indexed = index_scene(scene);
  const View view = small_view({0, 1.7, 0}, {0, 0, -1});
  EXPECT_TRUE(ask("occlusion_horizon", indexed, view).visible.contains(seen));
  const Answer shortcut = ask("occlusion_horizon:occluders=boxes", indexed, view);
  EXPECT_FALSE(shortcut.visible.contains(seen));
  EXPECT_GT(verdict_of(shortcut, scene, view).missed_samples, 0u);
  EXPECT_EQ(make_culler("occlusion_horizon:occluders=boxes", indexed)->promise(row), Promise::approximate);
}

TEST(OcclusionHorizon, CullsWhatIsBehindTheHousesOfACity) {
  const Scene scene = generate_scene("city", {.objects = 2000, .triangles = 0, .seed = 3});
  const IndexedScene indexed = index_scene(scene);
  const View view = street_view(scene);
  const Answer horizon = ask("occlusion_horizon", indexed, view), frustum = ask("frustum_linear", indexed, view);
  EXPECT_TRUE(verdict_of(horizon, scene, view).missed.empty());
  EXPECT_LT(2 * horizon.visible.count(), frustum.visible.count());
}

// Less is drawn and less is hidden the less an occluder may cost; the first one is always drawn.
TEST(OcclusionMasked, WorthDecidesWhatIsDrawnAndNothingElse) {
  const Scene scene = generate_scene("building", {.objects = 800, .triangles = 0, .seed = 3});
  const IndexedScene indexed = index_scene(scene);
  for (const View& view : cases::hard_views(scene, 16, 21)) {
    const auto with = [&](const std::string& worth) {
      return ask("occlusion_masked:triangles=1000000000:min_size=0:detail=0:worth=" + worth, indexed, view);
    };
    const Answer none = with("0"), some = with("1"), all = with("1000000000");
    EXPECT_LE(none.counters.occluders, 1u);
    EXPECT_GE(all.counters.occluder_triangles, some.counters.occluder_triangles);
    for (ObjectId id = 0; id < scene.objects().size(); ++id) {
      EXPECT_TRUE(none.visible.contains(id) || !all.visible.contains(id));
      EXPECT_TRUE(none.visible.contains(id) || !some.visible.contains(id));
    }
    for (const Answer* answer : {&none, &some, &all}) EXPECT_TRUE(verdict_of(*answer, scene, view).missed.empty());
  }
}

// Automatic occluders in the masked culler: they find what all triangles find, for fewer triangles.
TEST(AutoOccluders, FindWhatAllTrianglesFind) {
  const Scene scene = generate_scene("building", {.objects = 800, .triangles = 0, .seed = 3});
  const IndexedScene indexed = index_scene(scene);
  std::size_t all = 0, automatic = 0, frustum = 0;
  std::uint64_t all_triangles = 0, auto_triangles = 0;
  for (const View& view : cases::hard_views(scene, 16, 21)) {
    const Answer a = ask("occlusion_masked:triangles=1000000000:min_size=0:worth=1000000000", indexed, view);
    const Answer b = ask("occlusion_masked:occluders=auto:min_size=0", indexed, view);
    EXPECT_TRUE(verdict_of(b, scene, view).missed.empty());
    frustum += ask("frustum_linear", indexed, view).visible.count();
    all += a.visible.count();
    automatic += b.visible.count();
    all_triangles += a.counters.occluder_triangles;
    auto_triangles += b.counters.occluder_triangles;
  }
  EXPECT_GE(static_cast<double>(frustum - automatic), 0.9 * static_cast<double>(frustum - all));
  EXPECT_LT(auto_triangles, all_triangles);
}

}  // namespace
}  // namespace sightline
