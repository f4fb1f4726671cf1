// Detail culling: what is dropped covers less than the threshold, the pixels lost are counted, and hysteresis and
// motion do what they say (checklist 26).
#include <gtest/gtest.h>

#include "agreement/answer.hpp"
#include "sightline/oracle/oracle.hpp"
#include "sightline/scene/camera_path.hpp"
#include "sightline/scene/generate/generate.hpp"
#include "sightline/scene/generate/shapes.hpp"
#include "sightline/scene/input_error.hpp"

namespace sightline {
namespace {

struct Lost {
  std::uint64_t pixels = 0, objects = 0, largest = 0, dropped = 0;
};

/// Walks a path and counts pixels of objects that were dropped though seen.
Lost walk(const Scene& scene, const std::string& method, int frames) {
  const IndexedScene indexed = index_scene(scene);
  const Oracle oracle(scene);
  PathConfig config;
  config.frames = frames;
  config.prototype.width = 640;
  config.prototype.height = 360;
  const auto culler = make_culler(method, indexed), frustum = make_culler("frustum_linear", indexed);
  const VisibleSet all = VisibleSet::all(scene.objects().size());
  Lost lost;
  for (const View& view : generate_path(scene, config).views) {
    const VisibleSet visible = ask(*culler, view, all).visible, in_view = ask(*frustum, view, all).visible;
    EXPECT_TRUE(visible.subset_of(in_view));
    lost.dropped += in_view.count() - visible.count();
    const Truth truth = oracle.look(view);
    const Verdict verdict = judge(truth, visible);
    lost.pixels += verdict.missed_samples;
    lost.objects += verdict.missed.size();
    for (const ObjectId id : verdict.missed) lost.largest = std::max<std::uint64_t>(lost.largest, truth.samples[id]);
  }
  return lost;
}

TEST(Detail, NoObjectAboveTheThresholdIsLost) {
  const Scene scene = generate_scene("city", {.objects = 3000, .triangles = 0, .seed = 2});
  for (const char* estimate : {"ellipse", "silhouette"})
    for (const int pixels : {0, 4, 25, 200}) {
      const Lost lost = walk(scene, "detail:pixels=" + std::to_string(pixels) + ":estimate=" + estimate, 12);
      std::printf(
          "%-10s %4d pixels: %6llu dropped, %5llu of them seen, %6llu pixels lost, at most %llu of one object\n",
          estimate, pixels, static_cast<unsigned long long>(lost.dropped),
          static_cast<unsigned long long>(lost.objects), static_cast<unsigned long long>(lost.pixels),
          static_cast<unsigned long long>(lost.largest));
      // Pixel centres within a convex figure: at most its area and half its circumference, and one.
      EXPECT_LE(static_cast<double>(lost.largest), pixels + 2.0 * std::sqrt(3.2 * pixels) + (pixels > 0 ? 1 : 0));
      if (pixels == 0) {
        EXPECT_EQ(lost.dropped, 0u);
      }
      if (pixels == 200) {
        EXPECT_GT(lost.objects, 0u);  // the promise is approximate, and the measure sees it
      }
    }
}

/// One ball at growing distance.
Scene ball_scene() {
  SceneBuilder builder;
  builder.add_object(builder.add_mesh(make_ball(24, 12)), identity_affine());
  return builder.build();
}

bool drawn(Culler& culler, const View& view) { return ask(culler, view, VisibleSet::all(1)).visible.count() == 1; }

View from(double distance) { return look_along({0, 0, distance}, {0, 0, -1}); }

TEST(Detail, HysteresisKeepsWhatWasDrawn) {
  const Scene scene = ball_scene();
  const IndexedScene indexed = index_scene(scene);
  const auto switches = [&](const char* method) {
    const auto culler = make_culler(method, indexed);
    int count = 0;
    bool before = drawn(*culler, from(40));
    for (int i = 0; i < 60; ++i) {  // to and fro about the threshold
      const bool now = drawn(*culler, from(56.0 + 1.5 * (i % 3 - 1)));
      count += now != before ? 1 : 0;
      before = now;
    }
    return count;
  };
  EXPECT_GT(switches("detail:pixels=389"), 10);
  EXPECT_LE(switches("detail:pixels=389:hysteresis=0.3"), 1);
  // And reset forgets it.
  const auto culler = make_culler("detail:pixels=389:hysteresis=0.3", indexed),
             fresh = make_culler("detail:pixels=389:hysteresis=0.3", indexed);
  drawn(*culler, from(40));
  EXPECT_TRUE(drawn(*culler, from(58)));
  drawn(*culler, from(100));
  EXPECT_FALSE(drawn(*culler, from(54)));
  culler->reset();
  EXPECT_EQ(drawn(*culler, from(54)), drawn(*fresh, from(54)));
}

TEST(Detail, FasterCameraLargerThreshold) {
  const Scene scene = ball_scene();
  const IndexedScene indexed = index_scene(scene);
  const auto culler = make_culler("detail:pixels=300:motion=0.5", indexed);
  const View still = look_along({0, 0, 60}, {0, 0, -1}), turned = look_along({0, 0, 60}, {0.1, 0, -1});
  EXPECT_TRUE(drawn(*culler, still));
  EXPECT_TRUE(drawn(*culler, still));
  EXPECT_FALSE(drawn(*culler, turned));  // moved by some sixty pixels
  EXPECT_TRUE(drawn(*culler, turned));   // at rest again
}

TEST(Detail, BadParameters) {
  const Scene scene = ball_scene();
  const IndexedScene indexed = index_scene(scene);
  for (const char* method : {"detail:pixels=-1", "detail:estimate=best", "detail:size=3", "frustum_bounds:bound=cube",
                             "frustum_bounds:test=clip", "frustum_bounds:bound=kdop12"})
    EXPECT_THROW(make_culler(method, indexed), InputError) << method;
  for (const char* method : {"normal_mask:n=19", "cluster_backface:leaf=0", "backface:scalar=yes"})
    EXPECT_THROW(make_face_culler(method, indexed), InputError) << method;
}

}  // namespace
}  // namespace sightline
