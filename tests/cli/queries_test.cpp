// The verbs that answer questions: visible-faces, sight-lines, bsp, boolean, maze; and render --against.
#include "cli/program.hpp"

namespace sightline::cli_test {
namespace {

using Json = nlohmann::json;

class Queries : public ProgramTest {
 protected:
  struct Cube {
    double size, z;
  };
  /// A cube of two metres around the origin and a small one behind it.
  void SetUp() override {
    ProgramTest::SetUp();
    std::ofstream out(file("cubes.obj"));
    int base = 1;
    for (const Cube& cube : {Cube{1.0, 0.0}, Cube{0.2, -3.0}}) {
      const double size = cube.size, z = cube.z;
      out << "o cube" << base << "\n";
      for (int i = 0; i < 8; ++i)
        out << "v " << ((i & 1) != 0 ? size : -size) << " " << ((i & 2) != 0 ? size : -size) << " "
            << z + ((i & 4) != 0 ? size : -size) << "\n";
      constexpr int sides[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
      for (const auto& f : sides) out << "f " << base + f[0] << " " << base + f[1] << " " << base + f[2] << "\n";
      base += 8;
    }
  }
  void cameras(const std::string& text) { std::ofstream(file("cameras.json")) << text; }
  std::vector<std::string> faces(const std::string& output) {
    return {"visible-faces", file("cubes.obj"), "--cameras", file("cameras.json"), "-o", file(output)};
  }
};

constexpr const char* two_cameras = R"({"cameras": [
  {"name": "front", "width": 100, "height": 100, "fx": 100, "eye": [0, 0, 5], "look": [0, 0, -1]},
  {"name": "back", "width": 100, "height": 100, "fx": 100, "fy": 100, "cx": 50, "cy": 50,
   "rotation": [-1, 0, 0,  0, -1, 0,  0, 0, 1], "translation": [0, 0, 9]}]})";

TEST_F(Queries, VisibleFacesOfTwoCubes) {
  cameras(two_cameras);
  std::vector<std::string> words = faces("faces.json");
  for (const char* word : {"--samples", "--json", "-"}) words.emplace_back(word);
  const Outcome outcome = run(words);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.json().at("faces"), 24);
  const Json json = Json::parse(read_file(file("faces.json")));
  ASSERT_EQ(json.at("cameras").size(), 2u);
  // From the front: the two triangles of the large cube's near side, 50 x 50 pixels (2 m at 4 m).
  EXPECT_EQ(json.at("cameras")[0].at("seen"), Json({2, 3}));
  EXPECT_EQ(json.at("cameras")[0].at("samples")[0].get<int>() + json.at("cameras")[0].at("samples")[1].get<int>(),
            2500);
  // From behind, at z = -9: both cubes' far sides.
  EXPECT_EQ(json.at("cameras")[1].at("seen"), Json({0, 1, 12, 13}));
}

TEST_F(Queries, VisibleFacesAsNumpyAndCsv) {
  cameras(two_cameras);
  ASSERT_EQ(run(faces("faces.npy")).code, 0);
  const std::string npy = read_file(file("faces.npy"));
  EXPECT_EQ(npy.substr(1, 5), "NUMPY");
  const std::size_t head = 10 + static_cast<unsigned char>(npy[8]) + 256 * static_cast<unsigned char>(npy[9]);
  EXPECT_EQ(head % 64, 0u);
  EXPECT_NE(npy.find("'shape': (2, 24)"), std::string::npos);
  EXPECT_NE(npy.find("'|b1'"), std::string::npos);
  ASSERT_EQ(npy.size(), head + 48);
  EXPECT_EQ(npy.substr(head, 5), std::string("\0\0\1\1\0", 5));
  std::vector<std::string> words = faces("counts.npy");
  words.emplace_back("--samples");
  ASSERT_EQ(run(words).code, 0);
  EXPECT_EQ(read_file(file("counts.npy")).size() % 64, 48 * 4 % 64u);
  ASSERT_EQ(run(faces("faces.csv")).code, 0);
  EXPECT_EQ(
      read_file(file("faces.csv")),
      "camera,face,object,triangle\nfront,2,0,2\nfront,3,0,3\nback,0,0,0\nback,1,0,1\nback,12,1,0\nback,13,1,1\n");
}

TEST_F(Queries, PosesAgree) {
  // The same camera in four ways of writing, and an orthographic one.
  cameras(R"({"cameras": [
    {"width": 90, "height": 60, "fx": 80, "eye": [3, 2, 4], "target": [0, 0, 0]},
    {"width": 90, "height": 60, "fx": 80, "eye": [3, 2, 4], "look": [-3, -2, -4], "up": [0, 5, 0]},
    {"width": 90, "height": 60, "fx": 80, "qvec": [1, 0, 0, 0], "tvec": [0, 0, 5]},
    {"width": 90, "height": 60, "fx": 80, "rotation": [1,0,0, 0,1,0, 0,0,1], "translation": [0, 0, 5]},
    {"width": 90, "height": 60, "fx": 80, "camera_to_world": [1,0,0,0, 0,1,0,0, 0,0,1,-5, 0,0,0,1]},
    {"width": 90, "height": 60, "model": "orthographic", "span_y": 4, "eye": [0, 0, 5], "look": [0, 0, -1]}]})");
  std::vector<std::string> words = faces("faces.json");
  words.emplace_back("--samples");
  ASSERT_EQ(run(words).code, 0);
  const Json rows = Json::parse(read_file(file("faces.json"))).at("cameras");
  EXPECT_EQ(rows[0].at("samples"), rows[1].at("samples"));
  EXPECT_EQ(rows[2].at("samples"), rows[3].at("samples"));
  EXPECT_EQ(rows[2].at("samples"), rows[4].at("samples"));
  EXPECT_EQ(rows[5].at("samples")[0].get<int>() + rows[5].at("samples")[1].get<int>(), 900);
}

TEST_F(Queries, BadCamerasAreNamedByTheirPlace) {
  const auto refuse = [&](const std::string& camera, const std::string& place) {
    cameras("{\"cameras\": [" + camera + "]}");
    expect_complaint(faces("x.npy"), 3, "cameras.json");
    expect_complaint(faces("x.npy"), 3, place);
    EXPECT_FALSE(std::filesystem::exists(file("x.npy")));
  };
  const std::string good = R"("width": 9, "height": 9, "fx": 9, )", pose = R"("eye": [0,0,5], "look": [0,0,-1])";
  refuse("{" + pose + "}", "cameras[0].width");
  refuse(R"({"width": 9, "height": 9, )" + pose + "}", "cameras[0].fx");
  refuse(R"({"width": 0, "height": 9, "fx": 1, )" + pose + "}", "width");
  refuse(R"({"width": 99999, "height": 9, "fx": 1, )" + pose + "}", "width");
  refuse(R"({"width": 9, "height": 9, "fx": -1, )" + pose + "}", "fx");
  refuse(R"({"width": 9, "height": 9, "fx": "9", )" + pose + "}", "cameras[0].fx");
  refuse("{" + good + R"("model": "fisheye", )" + pose + "}", "cameras[0].model");
  refuse(R"({"width": 9, "height": 9, "model": "orthographic", )" + pose + "}", "span_y");
  refuse("{" + good + R"("eye": [0,0,5]})", "look");
  refuse("{" + good + R"("eye": [0,0], "look": [0,0,-1]})", "cameras[0].eye");
  refuse("{" + good + R"("eye": [0,0,5], "look": [0,0,0]})", "look");
  refuse("{" + good + R"("qvec": [1,1,0,0], "tvec": [0,0,0]})", "qvec");
  refuse("{" + good + R"("qvec": [1,0,0,0]})", "tvec");
  refuse("{" + good + R"("rotation": [2,0,0,0,1,0,0,0,1], "translation": [0,0,0]})", "orthonormal");
  refuse("{" + good + R"("rotation": [1,0,0,0,1,0,0,0,-1], "translation": [0,0,0]})", "mirrors");
  refuse("{" + good + R"("near": 5, "far": 4, )" + pose + "}", "far");
  refuse("{" + good + "\"cx\": 4}", "pose");
  refuse("7", "cameras[0]");
  cameras("{\"cameras\": [");
  expect_complaint(faces("x.npy"), 3, "cameras.json: JSON line 1");
  cameras("{\"cameras\": []}");
  expect_complaint(faces("x.npy"), 3, "has no cameras");
  cameras("{}");
  expect_complaint(faces("x.npy"), 3, "has no cameras");
  expect_complaint(faces("x.png"), 2, ".npy");
}

TEST_F(Queries, SightLinesNameWhatBlocks) {
  const Outcome one = run({"sight-lines", file("cubes.obj"), "--from", "0,0,5", "--to", "0,0,-9", "--json", "-"});
  ASSERT_EQ(one.code, 0) << one.err;
  const Json line = one.json().at("lines")[0];
  EXPECT_EQ(line.at("visible"), false);
  EXPECT_EQ(line.at("blocked_by").at("object"), 0);
  EXPECT_EQ(line.at("blocked_by").at("name"), "cube1");
  EXPECT_NEAR(line.at("blocked_by").at("point")[2].get<double>(), 1.0, 1e-9);
  EXPECT_NEAR(line.at("blocked_by").at("distance").get<double>(), 4.0, 1e-9);
  std::ofstream(file("from.txt")) << "# two points\n0 0 5\n\n4, 0, -3  # beside the small cube\n";
  std::ofstream(file("to.txt")) << "0 3 5\n-4 0 -3\n";
  const Json all =
      run({"sight-lines", file("cubes.obj"), "--from", file("from.txt"), "--to", file("to.txt"), "--json", "-"}).json();
  ASSERT_EQ(all.at("lines").size(), 4u);
  EXPECT_EQ(all.at("visible"), 3);
  EXPECT_EQ(all.at("lines")[3].at("blocked_by").at("object"), 1);
  const Outcome pairs =
      run({"sight-lines", file("cubes.obj"), "--pairs", "--from", file("from.txt"), "--to", file("to.txt")});
  EXPECT_NE(pairs.out.find("visible"), std::string::npos);
  EXPECT_NE(pairs.out.find("blocked by object 1 'cube9'"), std::string::npos) << pairs.out;
  // A point on a surface sees what is before it.
  const Json touching =
      run({"sight-lines", file("cubes.obj"), "--from", "0.1,0.2,1", "--to", "0,0,9", "--json", "-"}).json();
  EXPECT_EQ(touching.at("visible"), 1);
}

TEST_F(Queries, SightLinesRefuseWhatTheyCannotRead) {
  std::ofstream(file("bad.txt")) << "1 2 3\n1 two 3\n";
  expect_complaint({"sight-lines", file("cubes.obj"), "--from", file("bad.txt"), "--to", "0,0,0"}, 3, "line 2");
  expect_complaint({"sight-lines", file("cubes.obj"), "--from", file("none.txt"), "--to", "0,0,0"}, 3, "none.txt");
  std::ofstream(file("empty.txt")) << "# nothing\n";
  expect_complaint({"sight-lines", file("cubes.obj"), "--from", "0,0,1", "--to", file("empty.txt")}, 3, "no points");
  std::ofstream(file("two.txt")) << "0 0 0\n1 1 1\n";
  expect_complaint({"sight-lines", file("cubes.obj"), "--pairs", "--from", "0,0,1", "--to", file("two.txt")}, 2,
                   "--pairs");
  expect_complaint({"sight-lines", file("cubes.obj"), "--from", "0,0,1"}, 2, "--to");
}

TEST_F(Queries, BspReportsFragments) {
  const Json json =
      run({"bsp", "generate:city:objects=40", "--splitter", "mixed,random", "-o", file("plan.png"), "--json", "-"})
          .json();
  ASSERT_EQ(json.at("trees").size(), 2u);
  for (const Json& tree : json.at("trees")) EXPECT_GE(tree.at("fragments"), tree.at("polygons"));
  EXPECT_EQ(read_file(file("plan.png")).substr(1, 3), "PNG");
  const Json example = run({"bsp", "worked-example", "--json", "-"}).json().at("trees")[0];
  EXPECT_EQ(example.at("order"), Json({"4b", "5", "3", "1b", "4a", "2", "1a"}));
  const Json limited =
      run({"bsp", "generate:soup:objects=60", "--splitter", "random", "--most-fragments", "50", "--json", "-"}).json();
  EXPECT_EQ(limited.at("trees")[0].at("complete"), false);
  expect_complaint({"bsp", "worked-example", "--splitter", "luck,,"}, 2, "--splitter");
  expect_complaint({"bsp", "generate:city:objects=40", "--splitter", "luck"}, 2, "luck");
}

TEST_F(Queries, BooleanKeepsVolumes) {
  const std::string scene = file("cubes.obj");
  const std::pair<const char*, double> expected[] = {{"union", 8.064}, {"intersection", 8.064}, {"difference", 0.0}};
  for (const auto& [operation, volume] : expected) {
    const Outcome outcome = run({"boolean", scene, operation, scene, "-o", file("solid.glb"), "--json", "-"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NEAR(outcome.json().at("volume").get<double>(), volume, 1e-6) << operation;
  }
  expect_complaint({"boolean", scene, "xor", scene, "-o", file("x.glb")}, 2, "xor");
  expect_complaint({"boolean", scene, "union", scene, "-o", file("x.obj")}, 2, ".glb");
  std::ofstream(file("open.obj")) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  expect_complaint({"boolean", scene, "union", file("open.obj"), "-o", file("x.glb")}, 3, "closed");
}

TEST_F(Queries, MazeIsDrawn) {
  for (const char* extra : {"--quiet", "--fisheye"}) {
    const Outcome outcome =
        run({"maze", "--size", "120x80", "--seed", "4", extra, "-o", file(std::string(extra) + ".png"), "--json", "-"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.json().at("rays"), 120);
  }
  EXPECT_NE(read_file(file("--quiet.png")), read_file(file("--fisheye.png")));
  expect_complaint({"maze"}, 2, "--play");
  expect_complaint({"maze", "--play"}, 2, "terminal");
  expect_complaint({"maze", "--cells", "2x2", "-o", file("x.png")}, 2, "--cells");
}

TEST_F(Queries, RenderAgainstCountsDifferences) {
  const auto differences = [&](const char* method) {
    const Outcome outcome =
        run({"render", file("cubes.obj"), "--method", method, "--against", "oracle", "--eye", "3,2,4", "--look",
             "-3,-2,-4", "--size", "120x90", "-o", file("x.png"), "--json", "-"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.json().at("pixels_different").get<int>();
  };
  EXPECT_LE(differences("painter_bsp"), 3);
  EXPECT_LE(differences("whitted"), 3);
  expect_complaint({"render", file("cubes.obj"), "--against", "luck", "-o", file("x.png")}, 2, "luck");
}

TEST_F(Queries, HelpShowsExamples) {
  for (const char* verb : {"visible-faces", "sight-lines", "bsp", "boolean", "maze"}) {
    const Outcome outcome = run({verb, "--help"});
    EXPECT_EQ(outcome.code, 0);
    EXPECT_NE(outcome.out.find("Examples:"), std::string::npos) << verb;
  }
}

}  // namespace
}  // namespace sightline::cli_test
