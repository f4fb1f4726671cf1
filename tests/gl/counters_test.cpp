// Logs, counters and timelines: the same log byte for byte, counts that add up, a trace that a viewer reads.
#include <nlohmann/json.hpp>

#include "gl/registry.hpp"
#include "gl/with_context.hpp"
#include "sightline/scene/camera_path.hpp"
#include "sightline/scene/generate/generate.hpp"

namespace sightline::gl {
namespace {

class Counting : public WithContext {
 protected:
  Counting() : scene_(generate_scene("city", {.objects = 800, .triangles = 0, .seed = 2})) {
    View view;
    view.width = 240;
    view.height = 135;
    view.far = 4000.0;
    path_ = generate_path(scene_, {.frames = 40, .prototype = view});
  }

  struct Result {
    std::string log;
    Work work;
    std::vector<std::vector<ObjectId>> drawn;
  };
  Result run(const std::string& name, Timeline* timeline = nullptr) {
    SceneDrawing drawing(*context(), scene_);
    Result result;
    Target target;
    const auto method = make_method(name, drawing);
    method->set_log(&result.log);
    drawing.set_work(&result.work);
    drawing.set_timeline(timeline);
    for (const View& view : path_.views) {
      method->prepare(view, nullptr);
      method->frame(view, target);
      method->drawn(result.drawn.emplace_back());
    }
    drawing.set_work(nullptr);
    drawing.set_timeline(nullptr);
    return result;
  }
  Scene scene_;
  CameraPath path_;
};

TEST_F(Counting, DeterministicLogsAreTheSameByteForByte) {
  for (const char* name :
       {"gl_stop_and_wait", "gl_draw_and_wait", "gl_multiple_queries", "gl_overlap_free", "gl_chc:deterministic=on",
        "gl_chcpp:deterministic=on", "gl_chcpp:deterministic=on:batch=20", "gl_conditional"}) {
    const Result one = run(name), two = run(name);
    EXPECT_FALSE(one.log.empty()) << name;
    EXPECT_EQ(one.log, two.log) << name;
    EXPECT_EQ(one.drawn, two.drawn) << name;
  }
}

TEST_F(Counting, AnotherSeedAsksOtherwise) {
  EXPECT_NE(run("gl_chcpp:deterministic=on:seed=1").log, run("gl_chcpp:deterministic=on:seed=2").log);
}

TEST_F(Counting, CountsAddUp) {
  const auto frames = path_.views.size();
  const Result frustum = run("gl_frustum"), optimal = run("gl_optimal"), chc = run("gl_chc:deterministic=on");
  const Result chcpp = run("gl_chcpp:deterministic=on"), plain = run("gl_chcpp:deterministic=on:multiqueries=off");
  for (const Result* result : {&frustum, &optimal, &chc, &chcpp}) {
    EXPECT_EQ(result->work.frames, frames);
    std::size_t drawn = 0, triangles = 0, sizes = 0;
    for (const auto& ids : result->drawn) {
      drawn += ids.size();
      for (const ObjectId id : ids) triangles += scene_.mesh_of(id).triangles.size();
    }
    for (const std::uint64_t n : result->work.query_sizes) sizes += n;
    EXPECT_EQ(result->work.objects, drawn);
    EXPECT_EQ(result->work.triangles, triangles);
    EXPECT_EQ(result->work.queries, sizes);
    EXPECT_GE(result->work.objects, optimal.work.objects);
    EXPECT_LE(result->work.objects, frustum.work.objects);
  }
  EXPECT_EQ(frustum.work.queries, 0u);
  EXPECT_EQ(chc.work.multiqueries, 0u);
  EXPECT_EQ(plain.work.multiqueries, 0u);
  EXPECT_GT(chcpp.work.multiqueries, 0u);
  EXPECT_LT(chcpp.work.queries, chc.work.queries);
  EXPECT_LT(chcpp.work.state_changes, chc.work.state_changes / 5);
}

TEST_F(Counting, TheTraceIsOneThatViewersRead) {
  Timeline timeline;
  const Result result = run("gl_chcpp:deterministic=on", &timeline);
  const auto trace = nlohmann::json::parse(chrome_trace(timeline.spans(), "gl_chcpp"));
  std::size_t draws = 0, asks = 0, waits = 0, device = 0;
  for (const auto& event : trace.at("traceEvents")) {
    if (event.at("ph") != "X") continue;
    EXPECT_GE(event.at("dur").get<double>(), 0.0);
    const std::string kind = event.at("cat");
    device += event.at("tid") == 2 ? 1 : 0;
    if (event.at("tid") != 1) continue;
    draws += kind == "D" ? 1 : 0;
    waits += kind == "W" ? 1 : 0;
    if (kind == "Q") asks += event.at("args").at("count").get<std::size_t>();
  }
  EXPECT_GT(draws, path_.views.size());
  EXPECT_EQ(asks, result.work.queries);
  EXPECT_EQ(waits, result.work.blocking_waits);
  EXPECT_GT(device, draws);
}

}  // namespace
}  // namespace sightline::gl
