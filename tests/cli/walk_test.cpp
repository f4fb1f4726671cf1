// What a walk writes: the fields of the schema, their consistency, and the same answers for any number of threads.
#include <csignal>
#include <glm/glm.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <thread>

#include "cli/program.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/generate/generate.hpp"

namespace sightline::cli_test {
namespace {

using Json = nlohmann::json;

class Walk : public ProgramTest {
 protected:
  /// A small walk with JSON on standard output; `more` is added to the command line.
  [[nodiscard]] Outcome small_walk(const std::vector<std::string>& more) const {
    std::vector<std::string> words{
        "walk", "generate:city:objects=200:seed=5", "--frames", "5", "--size", "160x90", "--json", "-", "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
  /// All cullers of the registry, with commas between.
  static std::string all_cullers() {
    std::string names;
    for (const Algorithm& row : algorithms()) {
      if (row.family != Family::culler) continue;
      if (!names.empty()) names += ",";
      names += row.name;
    }
    return names;
  }
};

TEST_F(Walk, JsonHasTheFieldsOfTheSchema) {
  const Outcome outcome = small_walk({"--method", "frustum_hierarchical"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const Json json = outcome.json();  // throws if anything else was printed
  EXPECT_EQ(json.at("schema"), "sightline.walk/1");
  EXPECT_EQ(json.at("size"), Json({160, 90}));
  EXPECT_EQ(json.at("method"), "frustum_hierarchical");
  EXPECT_GT(json.at("scene").at("objects"), 0);
  EXPECT_GT(json.at("scene").at("triangles"), 0);
  EXPECT_FALSE(json.contains("objects"));
  ASSERT_EQ(json.at("frames").size(), 5u);
  double reported = 0, seen = 0, submitted = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    const Json& frame = json.at("frames")[i];
    EXPECT_EQ(frame.at("frame"), i);
    EXPECT_EQ(frame.at("eye").size(), 3u);
    EXPECT_EQ(frame.at("candidates"), json.at("scene").at("objects"));
    EXPECT_EQ(frame.at("visible"), frame.at("frustum"));  // both are frustum tests on the same boxes
    EXPECT_LE(frame.at("truth"), frame.at("visible"));
    EXPECT_EQ(frame.at("missed"), 0);
    EXPECT_TRUE(frame.at("missed_ids").is_array());
    EXPECT_GE(frame.at("cull_ms"), 0.0);
    EXPECT_GT(frame.at("truth_ms"), 0.0);
    EXPECT_FALSE(frame.contains("visible_ids"));
    reported += frame.at("visible").get<double>();
    seen += frame.at("truth").get<double>();
    submitted += frame.at("triangles_submitted").get<double>();
  }
  const Json& summary = json.at("summary");
  EXPECT_EQ(summary.at("missed"), 0);
  ASSERT_GT(seen, 0);
  EXPECT_DOUBLE_EQ(summary.at("overestimate"), reported / seen);
  EXPECT_NEAR(summary.at("triangles_fraction").get<double>(),
              submitted / 5 / json.at("scene").at("triangles").get<double>(), 1e-12);
  EXPECT_GE(summary.at("cull_ms_median"), 0.0);
  EXPECT_EQ(summary.at("verdict"), "ok");
}

TEST_F(Walk, WithoutTruthNothingIsClaimed) {
  const Outcome outcome = small_walk({"--method", "frustum_linear", "--no-verify"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json json = outcome.json();
  for (const char* key : {"truth", "missed", "missed_ids", "truth_ms"})
    EXPECT_TRUE(json.at("frames")[0].at(key).is_null()) << key;
  EXPECT_TRUE(json.at("summary").at("missed").is_null());
  EXPECT_TRUE(json.at("summary").at("overestimate").is_null());
  EXPECT_EQ(json.at("summary").at("verdict"), "unverified");
}

TEST_F(Walk, APromiseForPixelCentresIsJudgedThereWhateverTheSamples) {
  const Outcome outcome = run({"walk", "generate:city:objects=3000", "--frames", "20", "--size", "96x54", "--samples",
                               "4", "--method", "occlusion_virtual:step=1", "--json", "-"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const Json frames = outcome.json().at("frames");
  std::size_t missed = 0;
  for (const Json& frame : frames) {
    EXPECT_EQ(frame.at("missed"), frame.at("unpromised"));
    missed += frame.at("missed").get<std::size_t>();
  }
  EXPECT_GT(missed, 0u) << "the walk shows nothing";
}

TEST_F(Walk, SeveralMethodsShareOneTruth) {
  const Outcome outcome = small_walk({"--method", "none,frustum_linear"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json json = outcome.json();
  EXPECT_EQ(json.at("schema"), "sightline.walk/1");
  const Json& runs = json.at("runs");
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0].at("method"), "none");
  EXPECT_EQ(runs[1].at("method"), "frustum_linear");
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(runs[0].at("frames")[i].at("truth_ms"), runs[1].at("frames")[i].at("truth_ms"));
    EXPECT_EQ(runs[0].at("frames")[i].at("visible"), runs[0].at("frames")[i].at("candidates"));
    EXPECT_LT(runs[1].at("frames")[i].at("visible"), runs[1].at("frames")[i].at("candidates"));
  }
}

TEST_F(Walk, IdsAreObjectsOfTheScene) {
  const Outcome outcome = small_walk({"--method", "frustum_linear", "--ids"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json json = outcome.json();
  const Json& objects = json.at("objects");
  ASSERT_EQ(objects.size(), json.at("scene").at("objects"));
  for (std::size_t i = 0; i < objects.size(); ++i) {
    EXPECT_EQ(objects[i].at("id"), i);
    EXPECT_TRUE(objects[i].at("name").is_string());
    EXPECT_TRUE(objects[i].contains("source"));
  }
  for (const Json& frame : json.at("frames")) {
    const auto ids = frame.at("visible_ids").get<std::vector<std::size_t>>();
    EXPECT_EQ(ids.size(), frame.at("visible"));
    EXPECT_TRUE(std::is_sorted(ids.begin(), ids.end()));
    EXPECT_EQ(std::adjacent_find(ids.begin(), ids.end()), ids.end());
    EXPECT_TRUE(ids.empty() || ids.back() < objects.size());
  }
}

/// How far all corners of a box lie beyond the clip plane that they are farthest beyond, relative to their w; positive
/// means outside of the view.
double beyond_clip_space(const glm::dmat4& matrix, const Aabb& box) {
  double beyond = -1e300;
  for (int plane = 0; plane < 6; ++plane) {
    double nearest = 1e300;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec4 p = matrix * glm::dvec4(glm::dvec3(box.corner(corner)), 1.0);
      const double coordinate = plane % 2 == 0 ? p[plane / 2] : -p[plane / 2];
      nearest = std::min(nearest, (coordinate - p.w) / (std::abs(p.w) + 1.0));
    }
    beyond = std::max(beyond, nearest);
  }
  return beyond;
}

/// Whoever reads the JSON can project the scene again: what is reported is what lies in the clip space of the matrix.
TEST_F(Walk, IdsAgreeWithTheMatrix) {
  const Outcome outcome = small_walk({"--method", "frustum_linear", "--ids"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  GenerateConfig config;
  config.objects = 200;
  config.seed = 5;
  const Scene scene = generate_scene("city", config);
  const Json json = outcome.json();
  ASSERT_EQ(json.at("scene").at("objects"), scene.objects().size());
  std::size_t inside = 0, outside = 0;
  for (const Json& frame : json.at("frames")) {
    const auto ids = frame.at("visible_ids").get<std::vector<ObjectId>>();
    const auto numbers = frame.at("view_projection").get<std::vector<double>>();
    ASSERT_EQ(numbers.size(), 16u);
    const glm::dmat4 matrix = glm::make_mat4(numbers.data());
    const auto eye = frame.at("eye").get<std::vector<double>>();
    const glm::dvec4 at_eye = matrix * glm::dvec4(eye[0], eye[1], eye[2], 1.0);
    EXPECT_NEAR(glm::length(glm::dvec3(at_eye.x, at_eye.y, at_eye.w)), 0.0, 1e-9);
    for (ObjectId id = 0; id < scene.objects().size(); ++id) {
      const double beyond = beyond_clip_space(matrix, scene.objects()[id].bounds);
      const bool reported = std::binary_search(ids.begin(), ids.end(), id);
      EXPECT_TRUE(reported ? beyond < 1e-4 : beyond > 0.0) << "object " << id << " lies " << beyond << " beyond";
      ++(reported ? inside : outside);
    }
  }
  EXPECT_GT(inside, 0u);
  EXPECT_GT(outside, 0u);
}

TEST_F(Walk, ThreadsDoNotChangeTheAnswer) {
  const auto ids_with = [&](const char* threads) {
    const Outcome outcome = small_walk({"--method", all_cullers(), "--ids", "--threads", threads});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    Json answers;
    const Json json = outcome.json();
    for (const Json& run : json.at("runs"))
      for (const Json& frame : run.at("frames"))
        answers.push_back({run.at("method"), frame.at("visible_ids"), frame.at("truth"), frame.at("view_projection")});
    return answers;
  };
  const Json one = ids_with("1");
  EXPECT_GT(one.size(), 5u);
  EXPECT_EQ(one, ids_with("2"));
}

TEST_F(Walk, SeedChangesGeneratedScenesAndPaths) {
  const auto eyes = [&](const char* seed) {
    const Outcome outcome = run({"walk", "generate:city:objects=200", "--frames", "3", "--size", "32x32", "--json", "-",
                                 "--quiet", "--method", "none", "--no-verify", "--seed", seed});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    Json result;
    const Json json = outcome.json();
    for (const Json& frame : json.at("frames")) result.push_back(frame.at("eye"));
    return result;
  };
  EXPECT_EQ(eyes("1"), eyes("1"));
  EXPECT_NE(eyes("1"), eyes("2"));
}

TEST_F(Walk, PathFileIsFollowed) {
  std::ofstream(file("path.json")) << R"({"views":[{"eye":[1,2,3],"look":[1,0,0]},{"eye":[4,5,6],"look":[0,0,1]}]})";
  const Outcome outcome = run({"walk", "generate:city:objects=50", "--method", "none", "--path", file("path.json"),
                               "--frames", "2", "--size", "64x64", "--json", "-"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json json = outcome.json();
  EXPECT_EQ(json.at("frames")[0].at("eye"), Json({1.0, 2.0, 3.0}));
  EXPECT_EQ(json.at("frames")[1].at("eye"), Json({4.0, 5.0, 6.0}));
}

TEST_F(Walk, StressPathIsAnotherPath) {
  const Outcome walk = small_walk({"--method", "none", "--no-verify"});
  const Outcome stress = small_walk({"--method", "none", "--no-verify", "--path", "stress"});
  ASSERT_EQ(stress.code, 0) << stress.err;
  const Json one = walk.json(), other = stress.json();
  ASSERT_EQ(other.at("frames").size(), 5u);
  EXPECT_NE(one.at("frames")[0].at("eye"), other.at("frames")[0].at("eye"));
}

/// Without --far everything lies before the far plane: an eye far outside sees the scene.
TEST_F(Walk, FarPlaneFollowsTheEye) {
  std::ofstream(file("path.txt")) << "0 1000 90000 0 0 -1\n";
  const std::vector<std::string> words{"walk",     "generate:city:objects=50",
                                       "--method", "none",
                                       "--path",   file("path.txt"),
                                       "--frames", "1",
                                       "--fov",    "2",
                                       "--size",   "300x300",
                                       "--json",   "-"};
  const Outcome near = run(words);
  ASSERT_EQ(near.code, 0) << near.err;
  EXPECT_GT(near.json().at("frames")[0].at("truth"), 0);
  std::vector<std::string> cut = words;
  cut.insert(cut.end(), {"--far", "80000"});
  EXPECT_EQ(run(cut).json().at("frames")[0].at("truth"), 0);
}

/// Every method of the registry follows the objects or is made anew; the truth is that of the moved scene.
TEST_F(Walk, NothingIsMissedWhileObjectsMove) {
  const std::string methods = all_cullers();
  const Outcome outcome = small_walk({"--method", methods, "--moving", "0.5", "--ids"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Json json = outcome.json();
  EXPECT_GT(json.at("moving"), 50);
  EXPECT_LT(json.at("moving"), json.at("scene").at("objects"));
  std::size_t anew = 0;
  for (const Json& run : json.at("runs")) {
    const std::string promise = run.at("promise");
    if (promise != "approximate") {
      EXPECT_EQ(run.at("summary").at("missed"), 0) << run.at("method");
    }
    anew += run.at("summary").at("made_anew").get<bool>() ? 1 : 0;
    EXPECT_GT(run.at("summary").at("follow_ms_median"), 0.0);
    EXPECT_EQ(run.at("frames")[0].at("move_ms"), 0.0);
    EXPECT_EQ(run.at("frames")[0].at("follow_ms"), 0.0);
    EXPECT_GT(run.at("frames")[1].at("move_ms"), 0.0);
  }
  EXPECT_GT(anew, 0u);
  EXPECT_LT(anew, json.at("runs").size() / 2);
  const auto answers = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words{"--method", "frustum_linear,occlusion_masked", "--ids"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome walk = small_walk(words);
    EXPECT_EQ(walk.code, 0) << walk.err;
    Json ids;
    const Json walked = walk.json();
    for (const Json& run : walked.at("runs"))
      for (const Json& frame : run.at("frames")) ids.push_back(frame.at("visible_ids"));
    return ids;
  };
  EXPECT_EQ(answers({"--moving", "0.5"}), answers({"--moving", "0.5"}));
  EXPECT_NE(answers({"--moving", "0.5"}), answers({})) << "they do move";
}

TEST_F(Walk, TableAndVerdictAreText) {
  const Outcome outcome = run({"walk", "generate:city:objects=100", "--frames", "3", "--size", "64x64", "--method",
                               "frustum_linear", "--json", file("out.json")});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.err, "");                                              // no progress where there is no terminal
  EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 5);  // head, three frames, verdict
  EXPECT_NE(outcome.out.find("ok: nothing visible was missed in 3 frames"), std::string::npos) << outcome.out;
  EXPECT_EQ(outcome.out.find('\x1b'), std::string::npos);
  EXPECT_EQ(Json::parse(read_file(file("out.json"))).at("frames").size(), 3u);
}

TEST_F(Walk, InterruptKeepsWhatIsThere) {
  const pid_t child = start({"walk", "generate:city:objects=200", "--frames", "20000", "--method", "frustum_linear",
                             "--samples", "4", "--json", file("out.json"), "--quiet"});
  // The file is opened under a temporary name once interrupts are caught.
  const auto output_is_open = [&] {
    for (const auto& entry : std::filesystem::directory_iterator(file("")))
      if (entry.path().filename().string().ends_with(".part")) return true;
    return false;
  };
  for (int tries = 0; tries < 1000 && !output_is_open(); ++tries)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ASSERT_TRUE(output_is_open());
  kill(child, SIGINT);
  const Outcome outcome = finish(child);
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  const Json json = Json::parse(read_file(file("out.json")));
  EXPECT_EQ(json.at("summary").at("interrupted"), true);
  EXPECT_GE(json.at("frames").size(), 1u);
  EXPECT_LT(json.at("frames").size(), 20000u);
  EXPECT_FALSE(output_is_open()) << "a temporary file is left";
}

TEST_F(Walk, ReportIsOnePageWithTheData) {
  const Outcome outcome = run({"walk", "generate:city:objects=100", "--frames", "3", "--size", "64x36", "--method",
                               "frustum_linear,none", "--report", file("report")});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::string page = read_file(file("report/index.html"));
  EXPECT_EQ(page.find("SIGHTLINE_DATA"), std::string::npos);
  const std::size_t begin = page.find("{\"schema\":\"sightline.walk/1\"");
  ASSERT_NE(begin, std::string::npos);
  // The data ends with its last brace before the end of the statement.
  const std::size_t end = page.find("\n;", begin);
  ASSERT_NE(end, std::string::npos);
  const Json json = Json::parse(page.substr(begin, end - begin));
  const Json& report = json.at("report");
  EXPECT_EQ(report.at("frames").size(), 6u);  // three for each method
  const std::size_t objects = json.at("scene").at("objects");
  const auto base64_length = [](std::size_t bytes) { return (bytes + 2) / 3 * 4; };
  EXPECT_EQ(report.at("objects").at("bounds").get<std::string>().size(), base64_length(objects * 24));
  EXPECT_EQ(report.at("frames")[0].at("state").get<std::string>().size(), base64_length(objects));
  EXPECT_EQ(report.at("pictures").size(), 15u);  // three frames; three kinds and the overdraw of two methods
  EXPECT_EQ(report.at("pictures")[3].at("kind"), "overdraw");
  EXPECT_EQ(report.at("pictures")[4].at("kind"), "overdraw of none");
  EXPECT_NE(report.at("command").get<std::string>().find("--size 64x36"), std::string::npos);
  EXPECT_EQ(report.at("pictures")[0].at("png").get<std::string>().substr(0, 8), "iVBORw0K");
}

}  // namespace
}  // namespace sightline::cli_test
