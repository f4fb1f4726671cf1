// Camera paths: as many views as asked, the same again, in free space, not through surfaces, at eye height above
// floors.
#include "sightline/scene/camera_path.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "scene/shapes.hpp"
#include "sightline/oracle/oracle.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/scene/generate/generate.hpp"
#include "sightline/scene/input_error.hpp"
#include "sightline/scene/load/load.hpp"
#include "sightline/scene/path/free_space.hpp"

namespace sightline {
namespace {

PathConfig config_of(int frames, std::uint64_t seed = 1) {
  PathConfig config;
  config.frames = frames;
  config.seed = seed;
  config.prototype.near = 0.01;
  config.prototype.width = 320;
  config.prototype.height = 200;
  config.prototype.far = 5000;
  return config;
}

bool same(const View& a, const View& b) { return a.eye == b.eye && a.orientation == b.orientation; }

// The nearest surface from `from` towards `to`, as a distance; infinite if there is none before `to`.
double first_hit(const Oracle& oracle, const glm::dvec3& from, const glm::dvec3& to) {
  View view = look_along(from, to - from);
  view.width = view.height = 1;
  view.far = glm::length(to - from);
  view.near = 1e-4 * view.far;
  Frame frame;
  oracle.draw(view, frame);
  return frame.depth[0];
}

// What every path of every scene keeps.
void expect_sound(const Scene& scene, const CameraPath& path, const PathConfig& config) {
  ASSERT_EQ(path.views.size(), static_cast<std::size_t>(config.frames));
  const Oracle oracle(scene);
  double length = 0, longest = 0;
  for (std::size_t i = 0; i < path.views.size(); ++i) {
    const View& view = path.views[i];
    EXPECT_NO_THROW(check_view(view));
    EXPECT_EQ(view.width, config.prototype.width);
    EXPECT_EQ(view.near, config.prototype.near);
    EXPECT_FALSE(inside_closed_object(scene, view.eye)) << "frame " << i;
    if (i == 0) continue;
    const double step = glm::length(view.eye - path.views[i - 1].eye);
    length += step;
    longest = std::max(longest, step);
    if (step > 0) {
      EXPECT_EQ(first_hit(oracle, path.views[i - 1].eye, view.eye), std::numeric_limits<double>::infinity())
          << "the way from frame " << i - 1 << " goes through a surface";
    }
  }
  EXPECT_GT(length, 0);
  EXPECT_LE(longest, 2.5 * length / static_cast<double>(path.views.size())) << "constant speed";
}

class PathThrough : public testing::TestWithParam<std::string> {};

TEST_P(PathThrough, IsSound) {
  for (const std::uint32_t objects : {1u, 5u, 60u, 1000u, 6000u}) {
    SCOPED_TRACE(objects);
    const Scene scene = generate_scene(GetParam(), {objects, 0, 1});
    const PathConfig config = config_of(40, objects);
    expect_sound(scene, generate_path(scene, config), config);
  }
}

TEST_P(PathThrough, IsTheSameAgain) {
  const Scene scene = generate_scene(GetParam(), {800, 0, 1});
  for (const auto make : {generate_path, stress_path}) {
    const CameraPath path = make(scene, config_of(25));
    const ThreadLimit limit(1);
    const CameraPath again = make(scene, config_of(25)), other = make(scene, config_of(25, 2));
    ASSERT_EQ(again.views.size(), path.views.size());
    int different = 0;
    for (std::size_t i = 0; i < path.views.size(); ++i) {
      EXPECT_TRUE(same(path.views[i], again.views[i])) << i;
      different += same(path.views[i], other.views[i]) ? 0 : 1;
    }
    EXPECT_GT(different, 20) << "the seed must matter";
  }
}

std::vector<std::string> kinds() {
  std::vector<std::string> names;
  for (const Generator& generator : generators()) names.emplace_back(generator.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Generated, PathThrough, testing::ValuesIn(kinds()),
                         [](const auto& name) { return name.param; });

Scene scene_of(const Mesh& mesh, const Affine& transform) {
  SceneBuilder builder;
  builder.add_object(builder.add_mesh(mesh), transform);
  return builder.build();
}

TEST(CameraPath, GoesThroughTheLeastScenes) {
  Mesh flat;
  flat.positions = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}};
  flat.triangles = {{0, 2, 1}, {0, 3, 2}};
  Affine upright(glm::vec3(1, 0, 0), glm::vec3(0, 0, 1), glm::vec3(0, 1, 0), glm::vec3(0));
  for (const float size : {1e-3f, 1.0f, 50.0f, 1e4f})
    for (const Affine& turn : {identity_affine(), upright})
      for (const Mesh& mesh : {flat, shapes::cube()}) {
        Affine transform = turn;
        for (int c = 0; c < 3; ++c) transform[c] *= size;
        SCOPED_TRACE(size);
        const Scene scene = scene_of(mesh, transform);
        PathConfig config = config_of(30);
        config.prototype.near = 1e-3 * size;
        config.prototype.far = 1e3 * size;
        expect_sound(scene, generate_path(scene, config), config);
        EXPECT_EQ(stress_path(scene, config).views.size(), 30u);
      }
}

TEST(CameraPath, CirclesASingleSolid) {
  const Scene scene = scene_of(shapes::cube(), identity_affine());
  for (const View& view : generate_path(scene, config_of(50)).views) {
    const glm::dvec3 to_centre = glm::normalize(glm::dvec3(scene.bounds().centre()) - view.eye);
    EXPECT_GT(glm::dot(to_centre, view_direction(view)), 0.95);
  }
}

TEST(CameraPath, WalksAtEyeHeight) {
  const Scene scene = generate_scene("building", {3000, 0, 1});
  const Oracle oracle(scene);
  int upright = 0, frames = 0;
  for (const View& view : generate_path(scene, config_of(60)).views) {
    const double height = first_hit(oracle, view.eye, view.eye - glm::dvec3(0, 3, 0));
    upright += height > 1.0 && height < 2.1 ? 1 : 0;
    ++frames;
    EXPECT_LT(first_hit(oracle, view.eye, view.eye + glm::dvec3(0, 30, 0)), 20) << "rooms, not the lawn";
  }
  EXPECT_GE(upright, frames * 9 / 10);
}

TEST(CameraPath, OneFrameIsEnough) {
  const Scene scene = generate_scene("city", {200, 0, 1});
  EXPECT_EQ(generate_path(scene, config_of(1)).views.size(), 1u);
  EXPECT_EQ(stress_path(scene, config_of(1)).views.size(), 1u);
}

TEST(CameraPath, RefusesBadInput) {
  const Scene empty = SceneBuilder().build(), cube = scene_of(shapes::cube(), identity_affine());
  Mesh nothing;
  PathConfig bad_view = config_of(3);
  bad_view.prototype.near = -1;
  for (const auto make : {generate_path, stress_path}) {
    EXPECT_THROW(make(empty, config_of(3)), InputError);
    EXPECT_THROW(make(scene_of(nothing, identity_affine()), config_of(3)), InputError);
    EXPECT_THROW(make(cube, config_of(0)), InputError);
    EXPECT_THROW(make(cube, bad_view), InputError);
  }
}

TEST(StressPath, IsInsideAndAgainstThings) {
  const Scene scene = generate_scene("city", {2000, 0, 1});
  const PathConfig config = config_of(200);
  const CameraPath path = stress_path(scene, config);
  int inside = 0, outside_of_bounds = 0, vertical = 0, same_place = 0;
  for (std::size_t i = 0; i < path.views.size(); ++i) {
    const View& view = path.views[i];
    EXPECT_NO_THROW(check_view(view));
    inside += inside_closed_object(scene, view.eye) ? 1 : 0;
    outside_of_bounds += scene.bounds().contains(glm::vec3(view.eye)) ? 0 : 1;
    vertical += std::abs(view_direction(view).y) > 0.999 ? 1 : 0;
    same_place += i > 0 && view.eye == path.views[i - 1].eye ? 1 : 0;
  }
  EXPECT_GE(inside, 20);
  EXPECT_GE(outside_of_bounds, 15);
  EXPECT_GE(vertical, 15);
  EXPECT_GE(same_place, 30);
}

class PathThroughFile : public testing::TestWithParam<std::string> {};

TEST_P(PathThroughFile, IsSound) {
  const std::filesystem::path file =
      std::filesystem::path(SIGHTLINE_SOURCE_DIR) / "../shared/scenes" / (GetParam() + ".glb");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is missing: real scenes were NOT tested";
  const Scene scene = load_scene(file).scene;
  const PathConfig config = config_of(30);
  const CameraPath path = generate_path(scene, config);
  expect_sound(scene, path, config);
  const Oracle oracle(scene);
  std::size_t seen = 0;
  for (const View& view : path.views) seen += oracle.look(view).seen.count();
  EXPECT_GE(seen, path.views.size()) << "there must be something to see";
}

INSTANTIATE_TEST_SUITE_P(Real, PathThroughFile,
                         testing::Values("aws-hospital/aws-hospital", "country-kitchen/country-kitchen",
                                         "dover-city/dover-city", "freedoom-e1m5/freedoom-e1m5",
                                         "godot-rooms/godot-rooms", "intel-castle/intel-castle",
                                         "librequake-e1m1/librequake-e1m1", "medical-clinic/medical-clinic",
                                         "nexuiz-starship/nexuiz-starship", "scan-meshes/koala"),
                         [](const auto& name) {
                           std::string id = name.param.substr(0, name.param.find('/'));
                           std::replace(id.begin(), id.end(), '-', '_');
                           return id;
                         });

}  // namespace
}  // namespace sightline
