// Explanations of scenes whose answer is known by construction, and of every hard scene and view: each is confirmed by
// its second look and agrees with the truth.
#include "sightline/oracle/explain.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <span>
#include <vector>

#include "agreement/cases.hpp"
#include "sightline/registry.hpp"

namespace sightline {
namespace {

using cases::at;

View front_view(const glm::dvec3& eye = {0, 0, 10}) {
  View view = look_along(eye, {0, 0, -1});
  view.width = 160;
  view.height = 90;
  return view;
}

Explanation explain_in(const Scene& scene, const View& view, ObjectId id, int samples = 1) {
  const Oracle oracle(scene);
  return explain(scene, oracle, oracle.look(view, samples), view, id);
}

/// Two walls side by side, "left" (0) and "right" (1), before a cube (2).
Scene two_walls(float left_edge = -4, float gap = 0) {
  SceneBuilder builder;
  const MeshId wall = builder.add_mesh(cases::quad({0, -4, 0}, {4, 0, 0}, {0, 8, 0}));
  builder.add_object(wall, at({left_edge, 0, 0}), "left");
  builder.add_object(wall, at({left_edge + 4 + gap, 0, 0}), "right");
  builder.add_object(builder.add_mesh(cases::cube()), at({0, 0, -3}), "cube");
  return builder.build();
}

TEST(Explain, OccludersHaveTheirShares) {
  const Explanation why = explain_in(two_walls(), front_view(), 2);
  EXPECT_EQ(why.fate, Fate::occluded);
  ASSERT_EQ(why.covers.size(), 2u);
  EXPECT_EQ(why.covers[0].samples + why.covers[1].samples, why.alone_samples);
  EXPECT_NEAR(static_cast<double>(why.covers[0].samples), static_cast<double>(why.covers[1].samples),
              0.2 * static_cast<double>(why.alone_samples));
  EXPECT_EQ(why.seen_samples, 0u);
  EXPECT_EQ(why.contradiction, "");
  const Explanation one = explain_in(two_walls(-1.5f), front_view(), 2);
  EXPECT_EQ(one.fate, Fate::occluded);
  ASSERT_EQ(one.covers.size(), 1u);
  EXPECT_EQ(one.covers[0].object, 0u);
  EXPECT_EQ(one.contradiction, "");
}

TEST(Explain, WitnessHitsTheCubeThroughTheGap) {
  const Explanation why = explain_in(two_walls(-4.1f, 0.2f), front_view(), 2);
  ASSERT_EQ(why.fate, Fate::seen);
  ASSERT_TRUE(why.witness);
  EXPECT_NEAR(why.witness->x, 80.0, 3.0);
  EXPECT_NEAR(why.witness->hit.depth, 12.5, 1e-4);
  EXPECT_NEAR(why.witness->point.z, -2.5, 1e-4);
  EXPECT_LT(std::abs(why.witness->point.x), 0.12);
  EXPECT_GT(why.alone_samples, why.seen_samples);
  EXPECT_EQ(why.covers.size(), 2u);
  EXPECT_EQ(why.contradiction, "");
}

TEST(Explain, PlanesAndTheirMargins) {
  SceneBuilder builder;
  const MeshId cube = builder.add_mesh(cases::cube());
  for (const glm::vec3& place : {glm::vec3(-30, 0, 0), {30, 0, 0}, {0, -30, 0}, {0, 30, 0}, {0, 0, 15}, {0, 0, -90}})
    builder.add_object(cube, at(place));
  const Scene scene = builder.build();
  View view = front_view();
  view.far = 50;
  const char* names[] = {"left", "right", "bottom", "top", "near", "far"};
  for (ObjectId id = 0; id < 6; ++id) {
    const Explanation why = explain_in(scene, view, id);
    EXPECT_EQ(why.fate, Fate::outside) << id;
    ASSERT_TRUE(why.plane) << id;
    EXPECT_EQ(why.plane->name, names[id]);
    EXPECT_TRUE(why.plane->whole_box);
    EXPECT_EQ(why.contradiction, "");
  }
  EXPECT_NEAR(explain_in(scene, view, 4).plane->margin, 4.5 + 0.1, 1e-4);  // from z = 14.5 to the near plane at 9.9
  EXPECT_NEAR(explain_in(scene, view, 5).plane->margin, 49.5, 1e-4);
  view.projection = Projection::orthographic;
  view.span_y = 20;
  EXPECT_NEAR(explain_in(scene, view, 3).plane->margin, 19.5, 1e-4);
}

TEST(Explain, SmallerThanAPixelAndEmpty) {
  SceneBuilder builder;
  builder.add_object(builder.add_mesh(cases::cube(0.01f)), at({0.03f, 0.03f, 0}));
  builder.add_object(builder.add_mesh({"empty", {}, {}, false, {}}), at({0, 0, 0}));
  const Scene scene = builder.build();
  const Explanation why = explain_in(scene, front_view(), 0);
  EXPECT_EQ(why.fate, Fate::between_samples);
  ASSERT_TRUE(why.box_pixels);
  EXPECT_LT(why.box_pixels->x, 1.0);
  EXPECT_EQ(why.contradiction, "");
  EXPECT_EQ(explain_in(scene, front_view(), 1).fate, Fate::empty);
  EXPECT_EQ(explain_in(scene, front_view(), 0, 16).fate, Fate::seen);
}

TEST(Explain, GlassHidesNothing) {
  SceneBuilder builder;
  const MeshId wall = builder.add_mesh(cases::quad({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}));
  builder.add_object(wall, at({0, 0, 0}), "glass", {}, false);
  builder.add_object(wall, at({0, 0, -1}), "wall");
  builder.add_object(builder.add_mesh(cases::cube()), at({0, 0, -3}), "cube");
  const Scene scene = builder.build();
  EXPECT_EQ(explain_in(scene, front_view(), 1).fate, Fate::seen);
  const Explanation why = explain_in(scene, front_view(), 2);
  EXPECT_EQ(why.fate, Fate::occluded);
  ASSERT_EQ(why.covers.size(), 1u);
  EXPECT_EQ(why.covers[0].object, 1u);
  EXPECT_EQ(why.contradiction, "");
}

/// A truth that lies must not be confirmed: the second look is one.
TEST(Explain, AWrongTruthIsContradicted) {
  const Scene scene = two_walls();
  const Oracle oracle(scene);
  const View view = front_view();
  Truth truth = oracle.look(view);
  truth.samples[2] = 5;
  truth.seen.insert(2);
  EXPECT_NE(explain(scene, oracle, truth, view, 2).contradiction, "");
  truth = oracle.look(view);
  truth.samples[0] = 0;
  EXPECT_NE(explain(scene, oracle, truth, view, 0).contradiction, "");
}

TEST(Explain, EveryAnswerIsConfirmedAndAgrees) {
  for (const cases::Case& c : cases::generated()) {
    const Oracle oracle(c.scene);
    Random random(11);
    for (const View& view : cases::hard_views(c.scene, 24, 5)) {
      const Truth truth = oracle.look(view);
      for (int i = 0; i < 6; ++i) {
        ObjectId id = random.below(static_cast<std::uint32_t>(c.scene.objects().size()));
        if (i % 2 == 0 && truth.seen.count() > 0)
          id = truth.seen.order()[random.below(static_cast<std::uint32_t>(truth.seen.count()))];
        const Explanation why = explain(c.scene, oracle, truth, view, id);
        EXPECT_EQ(why.contradiction, "") << c.name << ": object " << id << " " << describe(view);
        EXPECT_EQ(why.fate == Fate::seen, truth.seen.contains(id)) << c.name;
      }
    }
  }
}

TEST(OracleTrace, SeesWhatLookSees) {
  const Scene scene = generate_scene("building", {.objects = 400});
  const Oracle oracle(scene);
  for (const View& view : cases::hard_views(scene, 8, 3)) {
    const Truth truth = oracle.look(view, 2);
    std::vector<std::atomic<std::uint32_t>> counts(scene.objects().size());
    oracle.trace(view, 2, {0, 0, view.width * 2, view.height * 2}, [&](int, int, std::span<const SurfaceHit> hits) {
      std::set<ObjectId> seen;  // a ray may enter and leave glass
      for (const SurfaceHit& hit : hits) seen.insert(hit.object);
      for (const ObjectId id : seen) ++counts[id];
    });
    for (std::size_t id = 0; id < counts.size(); ++id) EXPECT_EQ(counts[id], truth.samples[id]) << id;
  }
}

TEST(OracleTrace, CountsTheLayers) {
  const Scene scene = two_walls();
  const std::vector<std::uint8_t> counts = Oracle(scene).count_surfaces(front_view());
  EXPECT_EQ(counts[0], 0);
  EXPECT_EQ(counts[45 * 160 + 79], 3);  // a wall, front and back of the cube
  EXPECT_EQ(counts[45 * 160 + 60], 1);
  const VisibleSet only_cube = [&] {
    VisibleSet set(3);
    set.insert(2);
    return set;
  }();
  EXPECT_EQ(Oracle(scene, only_cube).count_surfaces(front_view())[45 * 160 + 79], 2);
}

}  // namespace
}  // namespace sightline
