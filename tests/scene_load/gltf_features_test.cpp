// glTF beyond plain triangles: other modes, sparse and quantised accessors, instancing, cameras, compression, and what
// is said about things that are not used. Compressed fixtures are made by the encoders of the libraries.
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

#include <glm/gtc/quaternion.hpp>

#include "scene_load/glb_fixture.hpp"

namespace sightline::test {
namespace {

using nlohmann::json;

GlbFixture with_mode(int mode, const std::vector<std::uint16_t>& indices) {
  GlbFixture fixture;
  const std::size_t points = fixture.add_points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}});
  fixture.add_mesh({{"attributes", {{"POSITION", points}}}, {"indices", fixture.add_indices(indices)}, {"mode", mode}});
  fixture.add_node({{"mesh", 0}});
  return fixture;
}

TEST(GltfModes, TriangleStripTurnsEveryOtherTriangle) {
  const Scene scene = load_bytes(with_mode(5, {0, 1, 2, 3, 4}).glb()).scene;
  ASSERT_EQ(scene.triangle_count(), 3u);
  const std::vector<glm::vec3> corners = corners_of(scene);
  for (std::size_t i = 0; i < 9; i += 3) {
    EXPECT_GT(glm::cross(corners[i + 1] - corners[i], corners[i + 2] - corners[i]).z, 0.0f) << i;
  }
}

TEST(GltfModes, TriangleFan) {
  const Scene scene = load_bytes(with_mode(6, {0, 1, 3, 2}).glb()).scene;
  ASSERT_EQ(scene.triangle_count(), 2u);
  const std::vector<glm::vec3> expected = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  EXPECT_EQ(corners_of(scene), expected);
}

TEST(GltfModes, PointsAndLinesAreSaidToBeLeftOut) {
  for (const int mode : {0, 1, 2, 3}) {
    const LoadedScene loaded = load_bytes(with_mode(mode, {0, 1, 2}).glb());
    EXPECT_TRUE(loaded.scene.objects().empty());
    EXPECT_EQ(loaded.warnings, std::vector<std::string>{"meshes[0].primitives[0]: points and lines are left out"});
  }
  EXPECT_EQ(load_error(with_mode(7, {0, 1, 2}).glb()), "meshes[0].primitives[0].mode: 7 is more than 6");
}

TEST(GltfModes, StripOfTwoCornersHasNoTriangles) {
  const LoadedScene loaded = load_bytes(with_mode(5, {0, 1}).glb());
  EXPECT_EQ(loaded.warnings, std::vector<std::string>{"meshes[0].primitives[0]: has no triangles, left out"});
}

TEST(GltfAccessors, SparseReplacesElements) {
  GlbFixture fixture = GlbFixture::square();
  fixture.add_node({{"mesh", 0}});
  const std::size_t targets = fixture.add_view(std::span<const std::uint16_t>(std::vector<std::uint16_t>{1, 3}));
  const std::size_t values = fixture.add_view(std::span<const glm::vec3>(std::vector<glm::vec3>{{5, 0, 0}, {0, 7, 0}}));
  json& points = fixture.json["accessors"][0];
  points["sparse"] = {{"count", 2},
                      {"indices", {{"bufferView", targets}, {"componentType", 5123}}},
                      {"values", {{"bufferView", values}}}};
  const std::vector<glm::vec3> expected = {{0, 0, 0}, {5, 0, 0}, {1, 1, 0}, {0, 7, 0}};
  EXPECT_EQ(load_bytes(fixture.glb()).scene.meshes()[0].positions, expected);

  points.erase("bufferView");  // zeros, some of them replaced
  const std::vector<glm::vec3> mostly_zero = {{0, 0, 0}, {5, 0, 0}, {0, 0, 0}, {0, 7, 0}};
  EXPECT_EQ(load_bytes(fixture.glb()).scene.meshes()[0].positions, mostly_zero);

  points["count"] = 3;
  fixture.json["accessors"][1]["count"] = 3;
  EXPECT_EQ(load_error(fixture.glb()), "accessors[0].sparse.indices: element 3 is beyond the accessor");
}

template <class Number>
std::vector<glm::vec3> quantised_positions(int component, bool normalized, const std::vector<Number>& numbers) {
  GlbFixture fixture;
  fixture.json["extensionsUsed"] = fixture.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  const std::size_t view = fixture.add_view(std::span(numbers));
  fixture.json["bufferViews"][view]["byteStride"] = 4 * sizeof(Number);
  const std::size_t points = fixture.add_accessor(view, component, "VEC3", 3);
  fixture.json["accessors"][points]["normalized"] = normalized;
  fixture.add_mesh({{"attributes", {{"POSITION", points}}}});
  fixture.add_node({{"mesh", 0}});
  const LoadedScene loaded = load_bytes(fixture.glb());
  EXPECT_TRUE(loaded.warnings.empty());
  return loaded.scene.meshes()[0].positions;
}

using Points = std::vector<glm::vec3>;

TEST(GltfAccessors, QuantisedPositions) {
  const std::vector<std::int8_t> bytes = {-128, -127, 127, 0, 0, 0, 0, 0, 0, 64, 1, 0};
  EXPECT_EQ(quantised_positions(5120, false, bytes), (Points{{-128, -127, 127}, {0, 0, 0}, {0, 64, 1}}));
  EXPECT_EQ(quantised_positions(5120, true, bytes),
            (Points{{-1, -1, 1}, {0, 0, 0}, {0, 64.0f / 127.0f, 1.0f / 127.0f}}));
  const std::vector<std::uint8_t> unsigned_bytes = {255, 0, 51, 0, 0, 0, 0, 0, 0, 64, 1, 0};
  EXPECT_EQ(quantised_positions(5121, false, unsigned_bytes), (Points{{255, 0, 51}, {0, 0, 0}, {0, 64, 1}}));
  EXPECT_EQ(quantised_positions(5121, true, unsigned_bytes),
            (Points{{1, 0, 0.2f}, {0, 0, 0}, {0, 64.0f / 255.0f, 1.0f / 255.0f}}));
  const std::vector<std::int16_t> shorts = {-32768, -32767, 32767, 0, 0, 0, 0, 0, 0, 64, 1, 0};
  EXPECT_EQ(quantised_positions(5122, false, shorts), (Points{{-32768, -32767, 32767}, {0, 0, 0}, {0, 64, 1}}));
  EXPECT_EQ(quantised_positions(5122, true, shorts),
            (Points{{-1, -1, 1}, {0, 0, 0}, {0, 64.0f / 32767.0f, 1.0f / 32767.0f}}));
  const std::vector<std::uint16_t> unsigned_shorts = {65535, 0, 13107, 0, 0, 0, 0, 0, 0, 64, 1, 0};
  EXPECT_EQ(quantised_positions(5123, false, unsigned_shorts), (Points{{65535, 0, 13107}, {0, 0, 0}, {0, 64, 1}}));
  EXPECT_EQ(quantised_positions(5123, true, unsigned_shorts),
            (Points{{1, 0, 0.2f}, {0, 0, 0}, {0, 64.0f / 65535.0f, 1.0f / 65535.0f}}));
}

TEST(GltfInstancing, EveryInstanceIsAnObject) {
  GlbFixture fixture = GlbFixture::square();
  fixture.json["extensionsUsed"] = fixture.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  const std::size_t translations = fixture.add_points({{10, 0, 0}, {20, 0, 0}, {30, 0, 0}});
  const std::size_t scales = fixture.add_points({{1, 1, 1}, {2, 2, 2}, {1, -1, 1}});
  // A quarter turn about z as normalised shorts, as the extension allows.
  const auto half = static_cast<std::int16_t>(std::lround(32767 * std::sqrt(0.5)));
  const std::vector<std::int16_t> turns = {0, 0, 0, 32767, 0, 0, half, half, 0, 0, 0, 32767};
  const std::size_t rotations = fixture.add_accessor(fixture.add_view(std::span(turns)), 5122, "VEC4", 3);
  fixture.json["accessors"][rotations]["normalized"] = true;
  fixture.add_node(
      {{"name", "tree"},
       {"mesh", 0},
       {"translation", {0, 100, 0}},
       {"extensions",
        {{"EXT_mesh_gpu_instancing",
          {{"attributes", {{"TRANSLATION", translations}, {"ROTATION", rotations}, {"SCALE", scales}}}}}}}});
  const LoadedScene loaded = load_bytes(fixture.glb());
  const Scene& scene = loaded.scene;
  ASSERT_EQ(scene.objects().size(), 3u);
  EXPECT_EQ(scene.meshes().size(), 1u);
  EXPECT_TRUE(loaded.warnings.empty());
  const glm::vec3 corner(1, 0, 0);
  EXPECT_EQ(transform_point(scene.objects()[0].transform, corner), glm::vec3(11, 100, 0));
  EXPECT_LT(glm::distance(transform_point(scene.objects()[1].transform, corner), glm::vec3(20, 102, 0)), 1e-5f);
  EXPECT_EQ(transform_point(scene.objects()[2].transform, glm::vec3(0, 1, 0)), glm::vec3(30, 99, 0));
  EXPECT_EQ(scene.name(2), "tree");
  EXPECT_EQ(scene.source(2).node, 0);

  fixture.json["accessors"][scales]["count"] = 2;
  EXPECT_EQ(load_error(fixture.glb()), "nodes[0].extensions.EXT_mesh_gpu_instancing.attributes: counts differ");
}

/// The square with a camera below a cart: nodes 0 (square), 1 (cart) and 2 (camera, looks along -z).
GlbFixture with_camera() {
  GlbFixture fixture = GlbFixture::square();
  fixture.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.25}}}}};
  fixture.add_node({{"mesh", 0}});
  fixture.add_node({{"children", {2}}, {"translation", {7, 7, 7}}});
  fixture.add_node({{"name", "eye"}, {"camera", 0}, {"translation", {0, 1, 0}}});
  fixture.json["scenes"] = {{{"nodes", {0, 1}}}};
  return fixture;
}

/// A channel that moves `path` of `node` through `values` at `times`.
void animate(GlbFixture& fixture, std::size_t node, const std::string& path, const std::string& interpolation,
             const std::vector<float>& times, const std::vector<float>& values) {
  const std::size_t components = path == "rotation" ? 4 : 3;
  const std::size_t input = fixture.add_accessor(fixture.add_view(std::span(times)), 5126, "SCALAR", times.size());
  const std::size_t output = fixture.add_accessor(fixture.add_view(std::span(values)), 5126,
                                                  components == 4 ? "VEC4" : "VEC3", values.size() / components);
  nlohmann::json& animation = fixture.json["animations"][0];
  animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
}

TEST(GltfCameras, MoveByTheirAnimation) {
  GlbFixture fixture = with_camera();
  const float half = std::sqrt(0.5f);
  animate(fixture, 1, "translation", "LINEAR", {1, 3}, {0, 0, 0, 10, 0, -4});
  animate(fixture, 2, "rotation", "LINEAR", {1, 5}, {0, 0, 0, 1, 0, half, 0, half});  // to look along -x
  const LoadedScene loaded = load_bytes(fixture.glb());
  EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings[0];
  ASSERT_EQ(loaded.moving_cameras.size(), 1u);
  const LoadedScene::MovingView& camera = loaded.moving_cameras[0];
  EXPECT_EQ(camera.name, "eye");
  EXPECT_EQ(camera.begin, 1.0);
  EXPECT_EQ(camera.end, 5.0);
  EXPECT_LT(glm::distance(camera.at(0).eye, glm::dvec3(0, 1, 0)), 1e-6) << "held before the first key";
  EXPECT_LT(glm::distance(camera.at(2).eye, glm::dvec3(5, 1, -2)), 1e-6);
  EXPECT_LT(glm::distance(camera.at(9).eye, glm::dvec3(10, 1, -4)), 1e-6);
  EXPECT_LT(glm::distance(view_direction(camera.at(1)), glm::dvec3(0, 0, -1)), 1e-6);
  EXPECT_LT(glm::distance(view_direction(camera.at(3)), glm::dvec3(-half, 0, -half)), 1e-6);
  EXPECT_LT(glm::distance(view_direction(camera.at(5)), glm::dvec3(-1, 0, 0)), 1e-6);
  EXPECT_EQ(camera.at(2).fov_y, 0.5);
  EXPECT_EQ(loaded.cameras[0].view.eye, glm::dvec3(7, 8, 7)) << "the standing camera is as modelled";
}

TEST(GltfCameras, CubicAndStepTracks) {
  GlbFixture fixture = with_camera();
  // Tangents of 0: the way is 3 t^2 - 2 t^3.
  animate(fixture, 1, "translation", "CUBICSPLINE", {0, 2}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 8, 0, 0, 0, 0, 0});
  animate(fixture, 2, "translation", "STEP", {0, 1}, {0, 0, 0, 0, 5, 0});
  const LoadedScene loaded = load_bytes(fixture.glb());
  ASSERT_EQ(loaded.moving_cameras.size(), 1u);
  const auto& at = loaded.moving_cameras[0].at;
  EXPECT_LT(glm::distance(at(0.5).eye, glm::dvec3(8 * 0.15625, 0, 0)), 1e-6);
  EXPECT_LT(glm::distance(at(0.99).eye, glm::dvec3(at(0.99).eye.x, 0, 0)), 1e-6);
  EXPECT_LT(glm::distance(at(1).eye, glm::dvec3(4, 5, 0)), 1e-6);
  // What moves no camera is said.
  animate(fixture, 0, "translation", "LINEAR", {0, 1}, {0, 0, 0, 1, 1, 1});
  EXPECT_EQ(load_bytes(fixture.glb()).warnings,
            std::vector<std::string>{"of the animations only what moves cameras is used"});
}

TEST(GltfCameras, BrokenAnimationsAreInputErrors) {
  const auto error_with = [](const std::function<void(nlohmann::json&)>& change) {
    GlbFixture fixture = with_camera();
    animate(fixture, 1, "translation", "LINEAR", {1, 3}, {0, 0, 0, 10, 0, -4});
    change(fixture.json);
    return load_error(fixture.glb());
  };
  EXPECT_EQ(error_with([](nlohmann::json&) {}), "no error");
  EXPECT_EQ(error_with([](nlohmann::json& j) { j["animations"][0]["samplers"][0]["interpolation"] = "CUBICSPLINE"; }),
            "animations[0].samplers[0].output: has not as many elements as there are times");
  EXPECT_EQ(error_with([](nlohmann::json& j) { j["animations"][0]["samplers"][0]["interpolation"] = "MAGIC"; }),
            "animations[0].samplers[0].interpolation: 'MAGIC' is none of LINEAR, STEP, CUBICSPLINE");
  EXPECT_NE(error_with([](nlohmann::json& j) { j["animations"][0]["channels"][0]["sampler"] = 9; }), "no error");
  EXPECT_NE(error_with([](nlohmann::json& j) { j["animations"][0]["channels"][0].erase("target"); }), "no error");
  EXPECT_NE(error_with([](nlohmann::json& j) { j["animations"][0]["samplers"][0].erase("input"); }), "no error");
  EXPECT_EQ(error_with([](nlohmann::json& j) {
              j["nodes"][1].erase("translation");
              j["nodes"][1]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
            }),
            "nodes[1].matrix: an animated node must have translation, rotation and scale instead");
  GlbFixture backwards = with_camera();
  animate(backwards, 1, "translation", "LINEAR", {3, 1}, {0, 0, 0, 10, 0, -4});
  EXPECT_EQ(load_error(backwards.glb()), "animations[0].samplers[0].input: the times do not ascend");
}

TEST(GltfCameras, ArriveInWorldSpace) {
  GlbFixture fixture = GlbFixture::square();
  fixture.json["cameras"] = {{{"type", "perspective"},
                              {"perspective", {{"yfov", 0.5}, {"aspectRatio", 2.0}, {"znear", 0.25}, {"zfar", 75.0}}}},
                             {{"type", "orthographic"},
                              {"name", "plan"},
                              {"orthographic", {{"xmag", 30}, {"ymag", 20}, {"znear", 1}, {"zfar", 9}}}},
                             {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.25}}}}};
  fixture.add_node({{"translation", {1, 2, 3}}, {"scale", {2, 2, 2}}, {"children", {1, 2}}});
  const double half = std::sqrt(0.5);
  fixture.add_node({{"name", "door"}, {"camera", 0}, {"translation", {1, 0, 0}}, {"rotation", {0, half, 0, half}}});
  fixture.add_node({{"camera", 1}, {"rotation", {-half, 0, 0, half}}});
  fixture.add_node({{"camera", 2}});
  const std::vector<LoadedScene::NamedView> cameras = load_bytes(fixture.glb()).cameras;
  ASSERT_EQ(cameras.size(), 3u);
  EXPECT_EQ(cameras[0].name, "door");
  EXPECT_LT(glm::distance(cameras[0].view.eye, glm::dvec3(3, 2, 3)), 1e-12);
  EXPECT_LT(glm::distance(view_direction(cameras[0].view), glm::dvec3(-1, 0, 0)), 1e-9);
  EXPECT_EQ(cameras[0].view.fov_y, 0.5);
  EXPECT_EQ(cameras[0].view.near, 0.25);
  EXPECT_EQ(cameras[0].view.far, 75.0);
  EXPECT_EQ(cameras[0].view.width, 2 * cameras[0].view.height);
  EXPECT_EQ(cameras[1].name, "plan");
  EXPECT_EQ(cameras[1].view.projection, Projection::orthographic);
  EXPECT_EQ(cameras[1].view.span_y, 40.0);
  EXPECT_EQ(cameras[1].view.width * 2, cameras[1].view.height * 3);
  EXPECT_LT(glm::distance(view_direction(cameras[1].view), glm::dvec3(0, -1, 0)), 1e-9);
  EXPECT_EQ(cameras[2].name, "node 3");
  EXPECT_TRUE(std::isinf(cameras[2].view.far));

  fixture.json["cameras"][0]["perspective"]["yfov"] = 4.0;
  EXPECT_EQ(load_error(fixture.glb()), "cameras[0]: the field of view must lie between 0.006 and 179.994 degrees");
}

TEST(GltfUnused, IsSaidOnceForEachKind) {
  GlbFixture fixture = GlbFixture::square();
  fixture.json["extensionsUsed"] = {"KHR_lights_punctual", "KHR_materials_unlit", "KHR_mesh_quantization"};
  fixture.json["animations"] = {json::object(), json::object()};
  fixture.json["skins"] = {json::object()};
  fixture.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", 0}}};
  json lines = {{"attributes", {{"POSITION", 0}}}, {"mode", 1}};
  for (int i = 0; i < 3; ++i) fixture.json["meshes"][0]["primitives"].push_back(lines);
  fixture.add_node({{"mesh", 0}, {"skin", 0}});
  const std::vector<std::string> expected = {"1 skins are not used",
                                             "2 animations are not used",
                                             "extension KHR_lights_punctual is not used",
                                             "extension KHR_materials_unlit is not used",
                                             "meshes[0].primitives[0]: morph targets are not used",
                                             "meshes[0].primitives[1] and 2 more: points and lines are left out"};
  EXPECT_EQ(load_bytes(fixture.glb()).warnings, expected);
}

TEST(GltfUnused, RequiredExtensionsMustBeKnownUnlessTheyAreAppearance) {
  GlbFixture fixture = GlbFixture::square();
  fixture.json["extensionsRequired"] = {"KHR_materials_unlit", "KHR_texture_basisu"};
  EXPECT_EQ(load_error(fixture.glb()), "no error");
  fixture.json["extensionsRequired"] = {"EXT_something_new"};
  EXPECT_EQ(load_error(fixture.glb()),
            "extensionsRequired: the file needs the extension EXT_something_new, which cannot be read");
}

}  // namespace
}  // namespace sightline::test
