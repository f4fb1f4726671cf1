// What sets the methods apart, each by its own example: who waits and how often, what is asked and what is not, what a
// query answers (checklist 22.02 to 22.20).
#include "gl/queries.hpp"
#include "gl/registry.hpp"
#include "gl/with_context.hpp"
#include "sightline/scene/camera_path.hpp"
#include "sightline/scene/generate/generate.hpp"
#include "sightline/scene/generate/shapes.hpp"

namespace sightline::gl {
namespace {

class Methods : public WithContext {
 protected:
  /// Boxes as objects 0, 1, ...
  static Scene scene_of(std::initializer_list<Aabb> boxes) {
    SceneBuilder builder;
    for (const Aabb& box : boxes) builder.add_object(builder.add_mesh(make_box(box.lo, box.hi)), identity_affine());
    return builder.build();
  }
  static View from_origin() {
    View view = look_along({0, 0, 0}, {0, 0, -1});
    view.width = 160;
    view.height = 90;
    return view;
  }
  /// Frames of a method; what each drew and cost.
  struct Seen {
    std::vector<ObjectId> drawn;
    Work work;
  };
  static std::vector<Seen> run(const Scene& scene, const std::string& name, const std::vector<View>& views) {
    SceneDrawing drawing(*context(), scene);
    Target target;
    const auto method = make_method(name, drawing);
    std::vector<Seen> frames;
    for (const View& view : views) {
      Seen& seen = frames.emplace_back();
      drawing.set_work(&seen.work);
      method->frame(view, target);
      method->drawn(seen.drawn);
      drawing.set_work(nullptr);
    }
    return frames;
  }
  static std::vector<View> walk(const Scene& scene, int frames) {
    View view = from_origin();
    view.far = 4000.0;
    return generate_path(scene, {.frames = frames, .prototype = view}).views;
  }
};

TEST_F(Methods, AQueryAnswersWhetherAndWithAThresholdHowMuch) {
  const Scene scene = scene_of({{{-4, -4, -11}, {4, 4, -10}}});
  SceneDrawing drawing(*context(), scene);
  Target target;
  drawing.begin(from_origin(), target);
  const ObjectId wall = 0;
  drawing.draw({&wall, 1});
  Frame before, after;
  target.read_back(from_origin(), before);
  const Aabb boxes[] = {{{-1, -1, -20}, {1, 1, -19}}, {{-1, -1, -6}, {1, 1, -5}}, {{14, 0, -20}, {16, 2, -19}}};
  const std::vector<OcclusionQueries::Ask> asks(3, {1, 1});
  for (const auto& [threshold, expected] :
       {std::pair{1u, std::vector{false, true, true}}, std::pair{150u, std::vector{false, true, false}}}) {
    OcclusionQueries queries(drawing, threshold);
    std::vector<unsigned> names;
    queries.issue(boxes, asks, names);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(queries.seen(names[i]), expected[i]) << threshold << " box " << i;
  }
  target.read_back(from_origin(), after);  // asking leaves no trace
  EXPECT_EQ(before.colour, after.colour);
  EXPECT_EQ(before.depth, after.depth);
  EXPECT_EQ(before.object, after.object);
}

TEST_F(Methods, StopAndWaitWaitsForEachAnswer) {
  const Scene scene = generate_scene("city", {.objects = 300, .triangles = 0, .seed = 2});
  for (const Seen& frame : run(scene, "gl_stop_and_wait", walk(scene, 3))) {
    EXPECT_GT(frame.work.queries, 0u);
    EXPECT_EQ(frame.work.blocking_waits, frame.work.queries);
  }
}

TEST_F(Methods, DrawAndWaitAsksOnceAndInVainWithoutOccluders) {
  const Scene scene = generate_scene("city", {.objects = 300, .triangles = 0, .seed = 2});
  const std::vector<View> views = walk(scene, 3);
  const auto all = run(scene, "gl_frustum", views), blind = run(scene, "gl_draw_and_wait:first=0", views),
             some = run(scene, "gl_draw_and_wait:first=0.3", views);
  for (std::size_t f = 0; f < views.size(); ++f) {
    EXPECT_EQ(some[f].work.state_changes, 1u);
    EXPECT_LE(some[f].work.blocking_waits, 1u);
    EXPECT_LT(some[f].drawn.size(), all[f].drawn.size());
    // E45: what is drawn first is only what the near plane cuts; the rest of the boxes has little to hide behind.
    EXPECT_GT(blind[f].drawn.size(), some[f].drawn.size());
  }
}

TEST_F(Methods, BundlesWaitOnceEach) {
  const Scene scene = generate_scene("city", {.objects = 300, .triangles = 0, .seed = 2});
  for (const int bundle : {10, 50})
    for (const Seen& frame : run(scene, "gl_multiple_queries:bundle=" + std::to_string(bundle), walk(scene, 3)))
      EXPECT_LE(frame.work.blocking_waits, frame.work.queries / static_cast<std::uint64_t>(bundle) + 1);
}

// 22.10, E46: what a larger bundle saves in stalls it pays in geometry that the bundle itself would have hidden. Two
// counts of the same walk; their quotient says how many triangles a stall must be worth.
TEST_F(Methods, LargerBundlesTradeStallsForGeometry) {
  const Scene scene = generate_scene("city", {.objects = 1000, .triangles = 0, .seed = 2});
  const std::vector<View> views = walk(scene, 3);
  const auto sum = [&](const std::string& name) {
    Work work;
    for (const Seen& frame : run(scene, name, views)) {
      work.blocking_waits += frame.work.blocking_waits;
      work.triangles += frame.work.triangles;
    }
    return work;
  };
  Work before = sum("gl_multiple_queries:bundle=1");
  const Work alone = sum("gl_stop_and_wait:hierarchy=off");
  EXPECT_EQ(before.blocking_waits, alone.blocking_waits);
  EXPECT_EQ(before.triangles, alone.triangles);
  for (const int bundle : {10, 50, 250}) {
    const Work work = sum("gl_multiple_queries:bundle=" + std::to_string(bundle));
    EXPECT_LT(work.blocking_waits, before.blocking_waits) << bundle;
    EXPECT_GT(work.triangles, before.triangles) << bundle;
    before = work;
  }
}

// 22.12: the nearest need no query, what they overlap is asked together, what that overlaps in a second bundle.
TEST_F(Methods, WhatDoesNotOverlapIsAskedTogether) {
  const Scene scene = scene_of({{{-6, -1, -11}, {-4, 1, -10}},
                                {{4, -1, -11}, {6, 1, -10}},
                                {{-8, -1, -16}, {-6, 1, -15}},
                                {{6, -1, -16}, {8, 1, -15}},
                                {{-9, -1, -21}, {-8, 1, -20}}});
  const auto frames = run(scene, "gl_overlap_free", {from_origin()});
  EXPECT_EQ(frames[0].drawn, (std::vector<ObjectId>{0, 1}));
  EXPECT_EQ(frames[0].work.queries, 3u);
  EXPECT_LE(frames[0].work.blocking_waits, 2u);
}

TEST_F(Methods, SmallerBatchesChangeStateMoreOften) {
  const Scene scene = generate_scene("city", {.objects = 2000, .triangles = 0, .seed = 2});
  std::uint64_t last = ~std::uint64_t{0};
  for (const int batch : {5, 20, 80}) {
    std::uint64_t changes = 0;
    const std::string name = "gl_chcpp:deterministic=on:multiqueries=off:batch=" + std::to_string(batch);
    for (const Seen& frame : run(scene, name, walk(scene, 8))) changes += frame.work.state_changes;
    EXPECT_LT(changes, last) << batch;
    last = changes;
  }
}

TEST_F(Methods, WhatWasVisibleIsDrawnBeforeAnythingIsAsked) {
  const Scene scene = generate_scene("city", {.objects = 400, .triangles = 0, .seed = 2});
  const View view = walk(scene, 1)[0];
  SceneDrawing drawing(*context(), scene);
  Target target;
  const auto method = make_method("gl_chcpp:deterministic=on", drawing);
  for (int f = 0; f < 3; ++f) method->frame(view, target);
  Timeline timeline;
  drawing.set_timeline(&timeline);
  method->frame(view, target);
  std::vector<ObjectId> drawn;
  method->drawn(drawn);
  drawing.set_timeline(nullptr);
  std::string kinds;
  std::uint32_t first_draw = 0;
  for (const Span& span : timeline.spans()) {
    if (span.lane != Lane::processor || (span.kind != 'D' && span.kind != 'Q')) continue;
    if (kinds.empty()) first_draw = span.count;
    kinds += span.kind;
  }
  ASSERT_FALSE(kinds.empty());
  EXPECT_EQ(kinds.front(), 'D');
  EXPECT_EQ(first_draw, drawn.size());  // nothing moved: all that is seen was seen
}

}  // namespace
}  // namespace sightline::gl
