// Camera paths from text and JSON files.
#include "sightline/scene/camera_path.hpp"

#include "scene_load/glb_fixture.hpp"

namespace sightline::test {
namespace {

CameraPath read_text(std::string_view text, int frames, const std::string& name = "path.txt") {
  const ScratchFolder folder;
  PathConfig config;
  config.frames = frames;
  config.prototype.far = 50.0;
  return read_path(folder.write(name, text), config);
}

std::string path_error(std::string_view text, int frames = 4) {
  try {
    read_text(text, frames);
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.position() + ": " + error.reason();
  }
  return "no error";
}

void expect_looks_along(const View& view, const glm::dvec3& direction) {
  EXPECT_LT(glm::distance(view_direction(view), glm::normalize(direction)), 1e-9);
}

TEST(ReadPath, DirectionIsThereOnlyIfThreeNumbersFollowTheEye) {
  const CameraPath path = read_text(
      "# comment\n"
      "1 2 3 0 0 5\n"
      "\r\n"
      "4 5 6 40\n"
      "7 8 9 item_health 1 0 0\n"
      "1e1\t+11 -12 1 0 0 trailing words # and a comment\r\n"
      "13 14 15 1 0 0x",
      5);
  ASSERT_EQ(path.views.size(), 5u);
  EXPECT_EQ(path.views[0].eye, glm::dvec3(1, 2, 3));
  expect_looks_along(path.views[0], {0, 0, 1});
  EXPECT_EQ(path.views[1].eye, glm::dvec3(4, 5, 6));
  EXPECT_EQ(path.views[2].eye, glm::dvec3(7, 8, 9));
  EXPECT_EQ(path.views[3].eye, glm::dvec3(10, 11, -12));
  expect_looks_along(path.views[3], {1, 0, 0});
  EXPECT_EQ(path.views[4].eye, glm::dvec3(13, 14, 15));
  for (const int open : {1, 2, 4}) EXPECT_NEAR(view_direction(path.views[open]).y, 0.0, 1e-12);
  EXPECT_EQ(path.views[0].far, 50.0);
}

TEST(ReadPath, EyesWithoutDirectionTurnOnceAboutTheVertical) {
  const CameraPath path = read_text("0 1 0\n5 1 0\n", 16);
  ASSERT_EQ(path.views.size(), 16u);
  for (int eye = 0; eye < 2; ++eye) {
    glm::dvec3 sum(0.0);
    for (int i = 0; i < 8; ++i) {
      const View& view = path.views[eye * 8 + i];
      EXPECT_EQ(view.eye.x, eye * 5.0);
      sum += view_direction(view);
      const View& next = path.views[eye * 8 + (i + 1) % 8];
      EXPECT_NEAR(glm::dot(view_direction(view), view_direction(next)), std::sqrt(0.5), 1e-9);
    }
    EXPECT_LT(glm::length(sum), 1e-9) << "the directions are spread evenly over the circle";
  }
}

TEST(ReadPath, DirectionOfLengthZeroIsThatOfTheLineBefore) {
  const CameraPath path = read_text("0 0 0 1 0 0\n1 0 0 0 -0.0 0\n2 0 0 0 0 1\n", 3);
  expect_looks_along(path.views[1], {1, 0, 0});
  EXPECT_EQ(path.views[1].eye.x, 1.0);
  expect_looks_along(path.views[2], {0, 0, 1});
  EXPECT_EQ(read_text("0 0 0 0 0 0\n", 1).views.size(), 1u) << "nothing before: an eye without direction";
}

TEST(ReadPath, FewerFramesThanLinesSkipEvenly) {
  std::string text;
  for (int i = 0; i < 100; ++i) text += std::to_string(i) + " 0 0 1 0 0\n";
  const CameraPath path = read_text(text, 10);
  ASSERT_EQ(path.views.size(), 10u);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(path.views[i].eye.x, 10.0 * i);
}

TEST(ReadPath, SeedTurnsTheOpenDirections) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.write("path.txt", "0 0 0\n");
  PathConfig config;
  config.frames = 1;
  const CameraPath first = read_path(file, config), again = read_path(file, config);
  config.seed = 2;
  const CameraPath other = read_path(file, config);
  EXPECT_EQ(view_direction(first.views[0]), view_direction(again.views[0]));
  EXPECT_GT(glm::distance(view_direction(first.views[0]), view_direction(other.views[0])), 0.01);
}

TEST(ReadPath, JsonViews) {
  const CameraPath path = read_text(R"({"views": [
      {"eye": [1, 2, 3], "look": [0, 0, 2], "up": [1, 0, 0], "fov": 90, "near": 0.5, "far": 7},
      {"eye": [1, 2, 3], "target": [1, 2, -5]},
      {"eye": [4, 5, 6]}]})",
                                    3, "path.json");
  ASSERT_EQ(path.views.size(), 3u);
  expect_looks_along(path.views[0], {0, 0, 1});
  EXPECT_LT(glm::distance(glm::mat3_cast(path.views[0].orientation)[1], glm::dvec3(1, 0, 0)), 1e-9);
  EXPECT_NEAR(path.views[0].fov_y, glm::radians(90.0), 1e-12);
  EXPECT_EQ(path.views[0].near, 0.5);
  EXPECT_EQ(path.views[0].far, 7.0);
  expect_looks_along(path.views[1], {0, 0, -1});
  EXPECT_EQ(path.views[1].far, 50.0);
  EXPECT_EQ(path.views[2].eye, glm::dvec3(4, 5, 6));
}

TEST(ReadPath, ErrorsNameTheLineOrField) {
  EXPECT_EQ(path_error("1 2 3\n1 2\n"), "line 2: a line must begin with three numbers: the eye");
  EXPECT_EQ(path_error("\n\nx y z\n"), "line 3: a line must begin with three numbers: the eye");
  EXPECT_EQ(path_error("1 2 nan\n"), "line 1: the eye of the view is not finite");
  EXPECT_EQ(path_error("1 2 1e999\n"), "line 1: the eye of the view is not finite");
  EXPECT_EQ(path_error("1 2 3 0 0 inf\n"), "line 1: the view direction must be finite and not zero");
  EXPECT_EQ(path_error("# nothing\n"), ": has no views");
  EXPECT_EQ(path_error(""), ": has no views");
  EXPECT_EQ(path_error(R"({"views":[]})"), ": has no views");
  EXPECT_EQ(path_error(R"({"views":[{"eye":[1,2,3]},{"look":[1,2,3]}]})"), "views[1].eye: is missing");
  EXPECT_EQ(path_error(R"({"views":[{"eye":[1,2]}]})"), "views[0].eye: must have 3 numbers");
  EXPECT_EQ(path_error(R"({"views":[{"eye":[1,2,3],"target":[1,2,3]}]})"),
            "views[0]: the view direction must be finite and not zero");
  EXPECT_EQ(path_error(R"({"views":[{"eye":[1,2,3],"fov":180}]})"),
            "views[0]: the field of view must lie between 0.006 and 179.994 degrees");
  EXPECT_EQ(path_error(R"({"views":[{"eye":[1,2,3],"look":[1,0,0],"target":[1,2,3]}]})"),
            "views[0]: has a look and a target");
  EXPECT_EQ(path_error(R"({"views":[)").substr(0, 28), "JSON line 1, column 11: synt");
  EXPECT_EQ(path_error("1 2 3\n", 0), ": frames must be from 1 to 10000000");
  EXPECT_THROW(read_path("/no such file.txt", {}), InputError);
}

TEST(ReadPath, RealViewpointFiles) {
  const std::filesystem::path scenes = std::filesystem::path(SIGHTLINE_SOURCE_DIR).parent_path() / "shared" / "scenes";
  if (!std::filesystem::exists(scenes)) GTEST_SKIP() << "REAL SCENES ARE MISSING: no folder " << scenes;
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(scenes)) {
    const std::filesystem::path file = entry.path() / "viewpoints.txt";
    if (!std::filesystem::exists(file)) continue;
    EXPECT_EQ(read_path(file, {}).views.size(), 120u) << file;
    ++files;
  }
  EXPECT_GE(files, 9);
  const CameraPath walk = read_path(scenes / "nexuiz-starship" / "path.txt", {});
  EXPECT_EQ(walk.views[0].eye, glm::dvec3(-15.267, 1.426, 10.279));
  expect_looks_along(walk.views[0], {-0.0062, -0.0124, 0.9999});
}

}  // namespace
}  // namespace sightline::test
