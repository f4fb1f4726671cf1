// The ten real scenes: what their README.md files say of them is what gets loaded.
#include <chrono>
#include <cmath>
#include <fstream>
#include <sstream>

#include "scene_load/glb_fixture.hpp"
#include "sightline/scene/load/load.hpp"

namespace sightline::test {
namespace {

struct RealScene {
  const char* folder;
  const char* file;
  const char* objects;    // as its README.md writes it, "22,532 buildings"; the scans' says one mesh for each file
  const char* triangles;  // as its README.md writes it, "1.02 M triangles"
  std::size_t meshes;     // distinct ones in the file
};

void PrintTo(const RealScene& scene, std::ostream* out) { *out << scene.folder << "/" << scene.file; }

std::filesystem::path scenes_folder() {
  return std::filesystem::path(SIGHTLINE_SOURCE_DIR).parent_path() / "shared" / "scenes";
}

/// 22532 for "22,532 buildings".
std::size_t leading_integer(const std::string& text) {
  std::size_t number = 0;
  for (const char c : text) {
    if (c == ',') continue;
    if (c < '0' || c > '9') break;
    number = number * 10 + static_cast<std::size_t>(c - '0');
  }
  return number;
}

/// The numbers that round to "1.02 M triangles": 1015000 to 1025000.
std::pair<double, double> rounded_range(const std::string& text) {
  const double unit = text.find(" M ") != std::string::npos ? 1e6 : 1e3;
  const std::string digits = text.substr(0, text.find(' '));
  const std::size_t point = digits.find('.');
  const double decimals = point == std::string::npos ? 0.0 : static_cast<double>(digits.size() - point - 1);
  const double half_step = 0.5 * std::pow(10.0, -decimals);
  return {(std::stod(digits) - half_step) * unit, (std::stod(digits) + half_step) * unit};
}

class RealScenes : public testing::TestWithParam<RealScene> {};

TEST_P(RealScenes, LoadAsTheirReadmeSays) {
  const RealScene& expected = GetParam();
  const std::filesystem::path folder = scenes_folder() / expected.folder;
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "REAL SCENES ARE MISSING: no folder " << folder;
  std::stringstream readme;
  readme << std::ifstream(folder / "README.md").rdbuf();
  // The table below is what the README says, not what we happen to load.
  ASSERT_NE(readme.str().find(expected.objects), std::string::npos) << readme.str();
  ASSERT_NE(readme.str().find(expected.triangles), std::string::npos) << readme.str();

  const auto start = std::chrono::steady_clock::now();
  const LoadedScene loaded = load_scene(folder / expected.file);
  const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
  RecordProperty("milliseconds", std::to_string(elapsed.count()));

  const std::size_t objects = leading_integer(expected.objects);
  EXPECT_EQ(loaded.scene.objects().size(), objects > 0 ? objects : 1);
  EXPECT_EQ(loaded.scene.meshes().size(), expected.meshes);
  const auto [lowest, highest] = rounded_range(expected.triangles);
  EXPECT_GE(static_cast<double>(loaded.scene.triangle_count()), lowest);
  EXPECT_LE(static_cast<double>(loaded.scene.triangle_count()), highest);
  EXPECT_TRUE(loaded.warnings.empty());
}

std::string test_name(const testing::TestParamInfo<RealScene>& parameter) {
  std::string name = std::filesystem::path(parameter.param.file).stem().string();
  for (char& c : name) {
    if (c == '-') c = '_';
  }
  return name;
}

const RealScene real_scenes[] = {
    {"aws-hospital", "aws-hospital.glb", "209 objects", "436 k triangles", 24},
    {"country-kitchen", "country-kitchen.glb", "285 objects", "1.02 M triangles", 285},
    {"dover-city", "dover-city.glb", "22,532 buildings", "441 k triangles", 22532},
    {"freedoom-e1m5", "freedoom-e1m5.glb", "1,037 sectors", "25 k triangles", 1037},
    {"godot-rooms", "godot-rooms.glb", "17,408 objects", "65.2 M triangles", 17},
    {"intel-castle", "intel-castle.glb", "2,114 objects", "1.07 M triangles", 437},
    {"librequake-e1m1", "librequake-e1m1.glb", "3,750 brushes", "47 k triangles", 3750},
    {"medical-clinic", "medical-clinic.glb", "9,486 objects", "1.35 M triangles", 9486},
    {"nexuiz-starship", "nexuiz-starship.glb", "914 objects", "13.4 k triangles", 914},
    {"scan-meshes", "koala.glb", "single meshes", "100 k triangles", 1},
    {"scan-meshes", "scorpion.glb", "single meshes", "100 k triangles", 1},
    {"scan-meshes", "skull.glb", "single meshes", "100 k triangles", 1},
};

INSTANTIATE_TEST_SUITE_P(All, RealScenes, testing::ValuesIn(real_scenes), test_name);

}  // namespace
}  // namespace sightline::test
