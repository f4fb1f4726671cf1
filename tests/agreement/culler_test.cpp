// Every culler of the registry against the oracle, at the promise that its row states: subsets of the candidates,
// nothing seen is missed, the same answer for any number of threads, no memory that a reset leaves behind.
#include <gtest/gtest.h>

#include "agreement/answer.hpp"
#include "agreement/cases.hpp"
#include "sightline/oracle/oracle.hpp"
#include "sightline/parallel/parallel.hpp"

namespace sightline {
namespace {

struct Contender {
  std::string text;
  Promise promise;
};

/// Every culler with its defaults, and settings that stress it.
std::vector<Contender> contenders() {
  std::vector<Contender> all;
  for (const Algorithm& row : algorithms())
    if (row.family == Family::culler) all.push_back({std::string(row.name), row.promise});
  for (const char* setting :
       {"occlusion_masked:occluders=auto:min_size=1", "occlusion_masked:occluders=auto:auto_budget=100000:resolution=1",
        "occlusion_horizon:columns=16", "occlusion_horizon:columns=4096", "occlusion_hzb:order=random:fan=3:min_size=0",
        "occlusion_hzb:order=worst:resolution=0.25", "occlusion_hom:block=1:min_size=0:resolution=1",
        "occlusion_hom:block=64:resolution=0.25", "occlusion_hom:depth=boxes",
        "occlusion_map:order=random:batch=3:min_size=0", "occlusion_map:order=worst:resolution=1",
        "occlusion_horizon:tight=1.4", "occlusion_hzb:tight=1.4", "occlusion_hzb:tight=4:min_size=0:order=random",
        "occlusion_hom:tight=1.4", "occlusion_hom:tight=4:depth=boxes", "occlusion_map:tight=1.4",
        "occlusion_map:tight=4:order=random:batch=3:min_size=0"})
    all.push_back({setting, Promise::conservative_continuous});
  for (const char* setting : {"step=1:min_size=0", "step=1:min_size=0:tight=1.4"})
    all.push_back({std::string("occlusion_virtual:") + setting, Promise::conservative});
  for (const char* setting : {"occlusion_hzb:pixels=30", "occlusion_hom:opacity=0.7:holes=9",
                              "occlusion_horizon:occluders=boxes", "occlusion_virtual:step=64:pixels=2"})
    all.push_back({setting, Promise::approximate});
  for (const char* setting :
       {"bound=ritter:coherence=on", "bound=aabb:test=clip", "bound=obb", "bound=kdop14:meta=on", "bound=hull"})
    all.push_back({std::string("frustum_bounds:") + setting, Promise::conservative_continuous});
  for (const char* setting :
       {"resolution=0.25", "resolution=1:min_size=0:detail=0:triangles=1000000:worth=1000000000", "resolution=0.11",
        "resolution=2", "scalar=on:min_size=1:detail=0:worth=0", "tight=1.4", "tight=4:resolution=1"})
    all.push_back({std::string("occlusion_masked:") + setting, Promise::conservative_continuous});
  all.push_back({"occlusion_masked:resolution=1:centres=on:min_size=1:detail=0", Promise::conservative});
  all.push_back({"frustum_hierarchical:corners=on", Promise::conservative_continuous});
  return all;
}

/// Few enough for large scenes: every row as it is, and what differs most from that.
std::vector<Contender> short_list() {
  std::vector<Contender> all;
  for (const Contender& contender : contenders())
    if (contender.text.find(':') == std::string::npos) all.push_back(contender);
  for (const char* setting : {"resolution=1:min_size=0:detail=0:triangles=1000000:worth=1000000000", "tight=1.4"})
    all.push_back({std::string("occlusion_masked:") + setting, Promise::conservative_continuous});
  for (const char* row : {"horizon", "hzb", "hom", "map"})
    all.push_back({"occlusion_" + std::string(row) + ":tight=1.4", Promise::conservative_continuous});
  return all;
}

/// The truths of a view that promises are held against.
struct Truths {
  Truths(const Oracle& oracle, const View& view) : centres(oracle.look(view)), between(oracle.look(view, 4)) {}
  [[nodiscard]] const Truth& of(Promise promise) const {
    return promise == Promise::conservative_continuous ? between : centres;
  }
  Truth centres, between;
};

void expect_nothing_missed(const std::string& name, const Scene& scene, const std::vector<View>& views,
                           const std::vector<Contender>& list) {
  const IndexedScene indexed = index_scene(scene);
  const Oracle oracle(scene);
  const VisibleSet all = VisibleSet::all(scene.objects().size());
  std::vector<std::unique_ptr<Culler>> cullers;
  for (const Contender& contender : list) cullers.push_back(make_culler(contender.text, indexed));
  for (std::size_t v = 0; v < views.size(); ++v) {
    check_view(views[v]);
    const Truths truths(oracle, views[v]);
    for (std::size_t c = 0; c < list.size(); ++c) {
      const VisibleSet visible = ask(*cullers[c], views[v], all).visible;
      if (list[c].promise == Promise::approximate) continue;
      const Truth& truth = truths.of(list[c].promise);
      const Verdict verdict = judge(truth, visible);
      EXPECT_TRUE(verdict.missed.empty())
          << list[c].text << " on " << name << ", view " << v << " (" << describe(views[v]) << "): object "
          << verdict.missed.front() << " missed, seen through " << truth.samples[verdict.missed.front()] << " samples";
    }
  }
}

TEST(CullerAgreement, NothingSeenIsMissedOnGeneratedScenes) {
  for (const cases::Case& c : cases::generated())
    expect_nothing_missed(c.name, c.scene, cases::hard_views(c.scene, 48, 11), contenders());
}

TEST(CullerAgreement, NothingSeenIsMissedOnRealScenes) {
  const auto files = cases::real_scenes();
  if (files.empty()) GTEST_SKIP() << "NO REAL SCENES: the folder shared/scenes beside the checkout is missing";
  for (const auto& file : files) {
    const LoadedScene loaded = load_scene(file);
    expect_nothing_missed(file.filename().string(), loaded.scene, cases::hard_views(loaded.scene, 8, 5), short_list());
  }
}

TEST(CullerAgreement, AnswersAreSubsetsOfTheCandidates) {
  const Scene scene = generate_scene("city", {.objects = 800, .triangles = 0, .seed = 3});
  const IndexedScene indexed = index_scene(scene);
  VisibleSet odd(scene.objects().size());
  for (ObjectId id = 1; id < scene.objects().size(); id += 2) odd.insert(id);
  for (const Contender& contender : contenders()) {
    const auto culler = make_culler(contender.text, indexed);
    for (const View& view : cases::hard_views(scene, 12, 2)) {
      const VisibleSet visible = ask(*culler, view, odd).visible;
      EXPECT_TRUE(visible.subset_of(odd)) << contender.text;
      EXPECT_EQ(visible.universe(), odd.universe()) << contender.text;
    }
  }
}

TEST(CullerAgreement, SameAnswersForEveryThreadCountAndAfterReset) {
  const Scene scene = generate_scene("building", {.objects = 500, .triangles = 0, .seed = 3});
  const IndexedScene indexed = index_scene(scene);
  const VisibleSet all = VisibleSet::all(scene.objects().size());
  for (const Contender& contender : contenders()) {
    const auto one = make_culler(contender.text, indexed), two = make_culler(contender.text, indexed);
    const auto forgetful = make_culler(contender.text, indexed);
    for (const View& view : cases::hard_views(scene, 10, 9)) {
      const auto with = [&](int threads, Culler& culler) {
        const ThreadLimit limit(threads);
        return ask(culler, view, all).visible.sorted();
      };
      EXPECT_EQ(with(1, *one), with(2, *two)) << contender.text;
      forgetful->reset();
      EXPECT_EQ(ask(*forgetful, view, all).visible.sorted(), ask(contender.text, indexed, view).visible.sorted())
          << contender.text;
    }
  }
}

TEST(CullerAgreement, EmptySceneGivesEmptyAnswers) {
  const Scene scene = SceneBuilder().build();
  const IndexedScene indexed = index_scene(scene);
  for (const Contender& contender : contenders())
    EXPECT_EQ(ask(contender.text, indexed, View()).visible.count(), 0u) << contender.text;
}

// The check itself must be able to fail: a culler that drops a seen object is caught.
TEST(CullerAgreement, TheVerdictFindsWhatIsMissing) {
  const Scene scene = cases::gap_scene(0.02f);
  const Oracle oracle(scene);
  View view = look_along({0, 0, 6}, {0, 0, -1});
  const Truth truth = oracle.look(view);
  ASSERT_GT(truth.seen.count(), 2u);
  VisibleSet visible(scene.objects().size());
  for (const ObjectId id : truth.seen.order())
    if (id != 0) visible.insert(id);
  const Verdict verdict = judge(truth, visible);
  ASSERT_EQ(verdict.missed, std::vector<ObjectId>{0});
  EXPECT_EQ(verdict.missed_samples, truth.samples[0]);
}

// Objects that move and turn from frame to frame, on the first frame after every move.
TEST(CullerAgreement, NothingSeenIsMissedAfterObjectsMoved) {
  for (const std::uint64_t seed : {1u, 2u}) {
    Scene scene = cases::moving_boxes(seed);
    IndexedScene indexed = index_scene(scene);
    const std::vector<Contender> list = contenders();
    std::vector<std::unique_ptr<Culler>> cullers;
    for (const Contender& contender : list) cullers.push_back(make_culler(contender.text, indexed));
    const VisibleSet all = VisibleSet::all(scene.objects().size());
    Random random(seed + 10);
    std::size_t culled = 0;
    for (int frame = 0; frame < 12; ++frame) {
      std::vector<Scene::Move> moves;
      for (ObjectId id = 0; id < scene.objects().size(); ++id)
        if (random.below(3) == 0)
          moves.push_back({id, cases::turned(random.range(0, 6),
                                             {random.range(-30, 30), random.range(-30, 30), random.range(-30, 30)})});
      scene.move_objects(moves);
      refit(indexed);
      View view = look_along({random.range(-30, 30), random.range(-30, 30), random.range(-30, 30)}, random.direction());
      view.width = 160;
      view.height = 90;
      const Truths truths(Oracle(scene), view);
      for (std::size_t c = 0; c < list.size(); ++c) {
        const std::string& text = list[c].text;
        const bool follows = cullers[c]->follow_scene();
        EXPECT_NE(follows, text.starts_with("frustum_bounds") || text.starts_with("detail")) << text;
        if (!follows) cullers[c] = make_culler(text, indexed);
        const VisibleSet visible = ask(*cullers[c], view, all).visible;
        culled += all.count() - visible.count();
        if (list[c].promise == Promise::approximate) continue;
        EXPECT_TRUE(judge(truths.of(list[c].promise), visible).missed.empty())
            << list[c].text << " in frame " << frame << ", seed " << seed;
      }
    }
    EXPECT_GT(culled, 1000u);
  }
}

}  // namespace
}  // namespace sightline
