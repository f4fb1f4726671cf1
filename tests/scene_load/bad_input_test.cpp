// Bad files: each gives one InputError with its place, none a crash, a wrong scene or a large allocation.
#include <sys/resource.h>

#include <functional>
#include <limits>

#include "scene_load/glb_fixture.hpp"

namespace sightline::test {
namespace {

using nlohmann::json;

GlbFixture square_in_node() {
  GlbFixture fixture = GlbFixture::square();
  fixture.add_node({{"mesh", 0}});
  return fixture;
}

/// The error of the square when `change` was made to its JSON.
std::string error_with(const std::function<void(json&)>& change) {
  GlbFixture fixture = square_in_node();
  fixture.json["buffers"] = {{{"byteLength", fixture.binary.size()}}};
  change(fixture.json);
  return load_error(fixture.glb());
}

TEST(BadInput, FilesThatAreNone) {
  const ScratchFolder folder;
  for (const char* extension : {".glb", ".gltf", ".obj", ".ply", ".stl", ".dae", ".fbx", ".3ds", ".ifc"}) {
    const std::string name = std::string("scene") + extension;
    EXPECT_EQ(load_error("", name), ": is empty");
    EXPECT_NE(load_error(std::string(100, '\0'), name), "no error");
    const std::filesystem::path missing = folder.path() / ("missing" + name), directory = folder.path() / name;
    std::filesystem::create_directory(directory);
    for (const auto& [path, reason] : {std::pair(missing, "no such file"), {directory, "is a directory, not a file"}}) {
      try {
        load_scene(path);
        ADD_FAILURE() << path;
      } catch (const InputError& error) {
        EXPECT_EQ(error.file(), path.string());
        EXPECT_EQ(error.reason(), reason);
      }
    }
  }
  EXPECT_EQ(load_error("x", "scene.blend"), ": '.blend' is none of .glb .gltf .obj .ply .stl .dae .fbx .3ds .ifc");
  EXPECT_EQ(load_error("x", "scene"), ": '' is none of .glb .gltf .obj .ply .stl .dae .fbx .3ds .ifc");
  EXPECT_THROW(load_scene("/dev/zero"), InputError);
}

TEST(BadInput, EveryTruncationOfAGlbIsSeen) {
  const std::string whole = square_in_node().glb();
  ASSERT_EQ(load_error(whole), "no error");
  const ScratchFolder folder;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_THROW(load_scene(folder.write("scene.glb", whole.substr(0, size))), InputError) << size;
  }
}

TEST(BadInput, GlbHeadersThatLie) {
  std::string glb = square_in_node().glb();
  const auto with_word = [&](std::size_t offset, std::uint32_t value) {
    std::string changed = glb;
    changed.replace(offset, 4, word(value));
    return load_error(changed);
  };
  EXPECT_EQ(with_word(4, 1), "byte 4: GLB version 1 is not 2");
  EXPECT_EQ(with_word(8, 0xFFFFFFFFu).substr(0, 37), "byte 8: the GLB claims 4294967295 byt");
  EXPECT_EQ(with_word(8, 3).substr(0, 30), "byte 8: the GLB claims 3 bytes");
  EXPECT_EQ(with_word(12, 0xFFFFFFFFu), "byte 12: chunk of 4294967295 bytes runs past the end of the file");
  EXPECT_EQ(with_word(16, 0), "byte 12: the first chunk of a GLB must be JSON");
  EXPECT_EQ(load_error("glTF" + word(2) + word(12)), "byte 12: the GLB has no JSON chunk");
}

TEST(BadInput, Json) {
  EXPECT_EQ(load_error("{", "scene.gltf").substr(0, 19), "JSON line 1, column");
  EXPECT_EQ(load_error("[]", "scene.gltf"), ": must be a JSON object");
  EXPECT_EQ(load_error("{}", "scene.gltf"), "asset: is missing: this is no glTF 2.0 file");
  EXPECT_EQ(load_error(R"({"asset":{"version":"1.0"}})", "scene.gltf"), "asset.version: '1.0' is not 2.x");
  EXPECT_EQ(load_error(R"({"asset":{"version":"2.0"},"nodes":[{"scale":[1e999,1,1]}]})", "scene.gltf").substr(0, 5),
            "JSON:");
  EXPECT_NE(load_error(std::string(1000000, '['), "scene.gltf"), "no error");
  EXPECT_NE(load_error("{\"asset\":\"\xff\"}", "scene.gltf"), "no error");
  const std::string deep =
      R"({"asset":{"version":"2.0"},"extras":)" + std::string(1000000, '[') + std::string(1000000, ']') + "}";
  EXPECT_EQ(load_error(deep, "scene.gltf"), "no error") << "depth costs no stack";
}

TEST(BadInput, RangesThatLie) {
  EXPECT_EQ(error_with([](json& j) { j["accessors"][0]["count"] = 5; }),
            "accessors[0]: 5 elements need 60 bytes, the buffer view has 48");
  EXPECT_EQ(error_with([](json& j) { j["accessors"][0]["count"] = 4294967295u; }),
            "accessors[0]: 4294967295 elements need 51539607540 bytes, the buffer view has 48");
  EXPECT_EQ(error_with([](json& j) { j["accessors"][0]["count"] = 1ull << 52; }),
            "accessors[0].count: 4503599627370496 is more than 4294967295");
  EXPECT_EQ(error_with([](json& j) { j["accessors"][0]["count"] = -1; }),
            "accessors[0].count: must be an integer from 0 to 2^53");
  EXPECT_EQ(error_with([](json& j) { j["accessors"][0]["count"] = 1.5; }),
            "accessors[0].count: must be an integer from 0 to 2^53");
  EXPECT_EQ(error_with([](json& j) { j["accessors"][0].erase("count"); }), "accessors[0].count: is missing");
  EXPECT_EQ(error_with([](json& j) { j["accessors"][0]["byteOffset"] = 4; }),
            "accessors[0]: 4 elements need 52 bytes, the buffer view has 48");
  EXPECT_EQ(error_with([](json& j) { j["accessors"][0]["byteOffset"] = 1ull << 53; }).substr(0, 35),
            "accessors[0]: 4 elements need 90071");
  EXPECT_EQ(error_with([](json& j) { j["accessors"][0]["componentType"] = 5124; }),
            "accessors[0].componentType: 5124 is no glTF component type");
  EXPECT_EQ(error_with([](json& j) { j["accessors"][0]["type"] = "VEC2"; }),
            "accessors[0].type: must have 3 components here");
  EXPECT_EQ(error_with([](json& j) { j["accessors"][0]["type"] = "MAT4"; }),
            "accessors[0].type: 'MAT4' is none of SCALAR, VEC2, VEC3, VEC4");
  EXPECT_EQ(error_with([](json& j) { j["accessors"][1]["componentType"] = 5122; }),
            "accessors[1].componentType: indices must be unsigned integers");
  EXPECT_EQ(error_with([](json& j) { j["bufferViews"][0]["byteStride"] = 8; }),
            "bufferViews[0].byteStride: 8 is less than the element size");
  EXPECT_EQ(error_with([](json& j) { j["bufferViews"][0]["byteLength"] = 1000; }),
            "bufferViews[0]: bytes 0 to 1000 lie outside buffers[0] of 60");
  EXPECT_EQ(error_with([](json& j) { j["bufferViews"][0]["byteOffset"] = 1ull << 53; }).substr(0, 22),
            "bufferViews[0]: bytes ");
  EXPECT_EQ(error_with([](json& j) { j["bufferViews"][0]["buffer"] = 1; }),
            "bufferViews[0].buffer: there is no entry 1, only 1");
  EXPECT_EQ(error_with([](json& j) { j["buffers"][0]["byteLength"] = 1000; }),
            "buffers[0].byteLength: 1000 bytes are claimed, 60 are there");
  EXPECT_EQ(error_with([](json& j) { j["buffers"][0]["uri"] = "missing.bin"; }).substr(0, 15), "buffers[0].uri:");
  EXPECT_EQ(
      error_with([](json& j) { j["accessors"][0].erase("bufferView"), j["accessors"][0]["count"] = 4000000000u; }),
      "accessors[0]: the file asks for more than 1024 MiB");
}

TEST(BadInput, IndicesBeyondTheVertices) {
  GlbFixture fixture;
  const std::size_t points = fixture.add_points({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}});
  fixture.add_mesh({{"attributes", {{"POSITION", points}}}, {"indices", fixture.add_indices<std::uint8_t>({0, 1, 3})}});
  fixture.add_node({{"mesh", 0}});
  EXPECT_EQ(load_error(fixture.glb()), "meshes[0].primitives[0].indices: vertex 3 is beyond the 3 there are");
}

TEST(BadInput, PositionsThatAreNotFinite) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity()}) {
    GlbFixture fixture;
    const std::size_t points = fixture.add_points({{0, 0, 0}, {1, 0, 0}, {1, bad, 0}});
    fixture.add_mesh({{"attributes", {{"POSITION", points}}}});
    fixture.add_node({{"mesh", 0}});
    EXPECT_EQ(load_error(fixture.glb()), "accessors[0]: element 2 is not finite");
  }
}

TEST(BadInput, NodesThatAreNoTree) {
  const auto error_of_nodes = [](const json& nodes, const json& roots) {
    return error_with([&](json& j) { j["nodes"] = nodes, j["scenes"] = {{{"nodes", roots}}}; });
  };
  const std::string twice = ": is reached twice: a node must have one parent and not be its own ancestor";
  EXPECT_EQ(error_of_nodes(json::array({{{"children", {0}}}}), {0}), "nodes[0]" + twice);
  EXPECT_EQ(error_of_nodes({{{"children", {1}}}, {{"children", {0}}}}, {0}), "nodes[0]" + twice);
  EXPECT_EQ(error_of_nodes({{{"children", {2}}}, {{"children", {2}}}, json::object()}, {0, 1}), "nodes[2]" + twice);
  EXPECT_EQ(error_of_nodes(json::array({json::object()}), {0, 0}), "nodes[0]" + twice);
  EXPECT_EQ(error_of_nodes(json::array({{{"children", {7}}}}), {0}), "nodes[0].children: there is no entry 7, only 1");
  EXPECT_EQ(error_of_nodes(json::array({json::object()}), {7}), "scenes[0].nodes: there is no entry 7, only 1");
  EXPECT_EQ(error_of_nodes(json::array({{{"mesh", 7}}}), {0}), "nodes[0].mesh: there is no entry 7, only 1");
  EXPECT_EQ(error_of_nodes(json::array({1}), {0}), "nodes[0]: must be a JSON object");
}

TEST(BadInput, TransformsThatAreNone) {
  const auto error_of_node = [](const json& node) { return error_with([&](json& j) { j["nodes"][0].update(node); }); };
  EXPECT_EQ(error_of_node({{"rotation", {0, 0, 0, 0}}}), "nodes[0].rotation: is no rotation");
  EXPECT_EQ(error_of_node({{"scale", {1, 1}}}), "nodes[0].scale: must have 3 numbers");
  EXPECT_EQ(error_of_node({{"scale", {1, 1, "x"}}}), "nodes[0].scale: must have numbers only");
  EXPECT_EQ(error_of_node({{"translation", {1e39, 0, 0}}}), "nodes[0]: its world transform is not finite");
  EXPECT_EQ(error_of_node({{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2}}}),
            "nodes[0].matrix: its last row must be 0 0 0 1");
}

std::size_t peak_memory_kilobytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss);
}

TEST(BadInput, SmallFilesCannotAskForAllMemory) {
  // 6000 nodes that share a mesh of 6000 primitives: 36 million objects from half a megabyte.
  GlbFixture fixture = GlbFixture::square();
  const json primitive = fixture.json["meshes"][0]["primitives"][0];
  for (int i = 1; i < 6000; ++i) fixture.json["meshes"][0]["primitives"].push_back(primitive);
  for (int i = 0; i < 6000; ++i) fixture.add_node({{"mesh", 0}});
  const std::string glb = fixture.glb();
  const std::size_t before = peak_memory_kilobytes();
  EXPECT_NE(load_error(glb).find("the file has more than 16777216 objects"), std::string::npos);

  // A thousand nodes that each place the instances of one accessor that has no data behind it.
  GlbFixture instances = GlbFixture::square();
  instances.json["accessors"].push_back({{"componentType", 5126}, {"type", "VEC3"}, {"count", 16000}});
  for (int i = 0; i < 1000; ++i) {
    instances.add_node(
        {{"mesh", 0}, {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", 2}}}}}}}});
  }
  EXPECT_EQ(load_error(instances.glb()).substr(0, 29), ": the file asks for more than");
  EXPECT_LT(peak_memory_kilobytes() - before, 200u * 1024u);
}

/// Every value of a document, one after the other, replaced by wrong ones: always a scene or an InputError.
void replace_each(json& whole, json& part, const std::function<void()>& check) {
  for (const json& wrong : {json(), json(-1), json(0), json(1e300), json("x"), json::array(), json::object(),
                            json(4294967295u), json(true), json(json::array({json::array()}))}) {
    const json kept = std::exchange(part, wrong);
    check();
    part = kept;
  }
  if (!part.is_structured()) return;
  for (json& child : part) replace_each(whole, child, check);
}

TEST(BadInput, AnyValueMayBeWrong) {
  GlbFixture fixture = square_in_node();
  json& j = fixture.json;
  j["buffers"] = {{{"byteLength", fixture.binary.size()}}};
  j["scene"] = 0;
  j["scenes"] = {{{"nodes", {0}}}};
  j["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.25}}}}};
  j["materials"] = {
      {{"alphaMode", "BLEND"}, {"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 0.5}}}}}}};
  j["meshes"][0]["primitives"][0]["material"] = 0;
  j["meshes"][0]["primitives"][0]["targets"] = json::array();
  j["accessors"].push_back({{"componentType", 5126}, {"type", "VEC3"}, {"count", 4}});
  j["accessors"][2]["sparse"] = {
      {"count", 1}, {"indices", {{"bufferView", 1}, {"componentType", 5123}}}, {"values", {{"bufferView", 0}}}};
  j["nodes"][0].update({{"camera", 0},
                        {"name", "n"},
                        {"rotation", {0, 0, 0, 1}},
                        {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"SCALE", 2}}}}}}}});
  ASSERT_EQ(load_error(fixture.glb()), "no error");
  const ScratchFolder folder;
  int loaded = 0, refused = 0;
  replace_each(j, j, [&] {
    try {
      load_scene(folder.write("scene.glb", GlbFixture::glb_of(j.dump(), fixture.binary)));
      ++loaded;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      ++refused;
    }
  });
  EXPECT_GT(loaded, 30);
  EXPECT_GT(refused, 400);
}

}  // namespace
}  // namespace sightline::test
