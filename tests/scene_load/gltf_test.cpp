// What a glTF file means: hierarchy, sharing, transforms, indices, materials, where buffers may lie.
#include "scene_load/glb_fixture.hpp"
#include "sightline/scene/load/load.hpp"

namespace sightline::test {
namespace {

using nlohmann::json;

TEST(Gltf, NodesShareMeshesAndComposeTransforms) {
  GlbFixture fixture = GlbFixture::square();
  fixture.json["meshes"][0]["name"] = "square";
  fixture.add_node({{"name", "parent"}, {"translation", {10, 0, 0}}, {"children", {1, 2}}});
  fixture.add_node({{"name", "first"}, {"mesh", 0}, {"scale", {2, 2, 2}}});
  fixture.add_node({{"mesh", 0}, {"matrix", {0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 5, 0, 1}}, {"children", {3}}});
  fixture.add_node({{"name", "turned"}, {"mesh", 0}, {"rotation", {0, 0, 0.70710678118654752, 0.70710678118654752}}});
  const LoadedScene loaded = load_bytes(fixture.glb());
  const Scene& scene = loaded.scene;
  ASSERT_EQ(scene.meshes().size(), 1u);
  ASSERT_EQ(scene.objects().size(), 3u);
  EXPECT_EQ(scene.triangle_count(), 6u);
  EXPECT_EQ(scene.name(0), "first");
  EXPECT_EQ(scene.name(1), "square");
  EXPECT_EQ(scene.name(2), "turned");
  EXPECT_EQ(scene.source(2).node, 3);
  EXPECT_EQ(scene.source(2).primitive, 0);
  const glm::vec3 corner(1, 1, 0);
  EXPECT_EQ(transform_point(scene.objects()[0].transform, corner), glm::vec3(12, 2, 0));
  EXPECT_EQ(transform_point(scene.objects()[1].transform, corner), glm::vec3(10, 6, -1));
  // The child turns by 90 degrees about z first: (1, 1, 0) -> (-1, 1, 0); then the parent's x goes to -z.
  const glm::vec3 turned = transform_point(scene.objects()[2].transform, corner);
  EXPECT_NEAR(glm::distance(turned, glm::vec3(10, 6, 1)), 0.0f, 1e-6f);
  EXPECT_TRUE(loaded.warnings.empty());
}

TEST(Gltf, NamesCommandNoTerminal) {
  GlbFixture fixture = GlbFixture::square();
  fixture.add_node({{"name", "a\x1b[31m\nred\0"}, {"mesh", 0}});
  EXPECT_EQ(load_bytes(fixture.glb()).scene.name(0), "a [31m red");
}

TEST(Gltf, ObjectsAreNodeTimesPrimitiveInTraversalOrder) {
  GlbFixture fixture = GlbFixture::square();
  json primitives = fixture.json["meshes"][0]["primitives"];
  primitives.push_back({{"attributes", {{"POSITION", 0}}}});
  primitives[1]["indices"] = fixture.add_indices<std::uint8_t>({0, 1, 3});
  fixture.json["meshes"][0]["primitives"] = primitives;
  fixture.add_node({{"mesh", 0}, {"children", {2}}});
  fixture.add_node({{"mesh", 0}});
  fixture.add_node({{"mesh", 0}});
  const Scene scene = load_bytes(fixture.glb()).scene;
  ASSERT_EQ(scene.objects().size(), 6u);
  EXPECT_EQ(scene.meshes().size(), 2u);
  const int nodes[] = {0, 0, 2, 2, 1, 1};
  for (ObjectId id = 0; id < 6; ++id) {
    EXPECT_EQ(scene.source(id).node, nodes[id]);
    EXPECT_EQ(scene.source(id).primitive, static_cast<int>(id % 2));
    EXPECT_EQ(scene.mesh_of(id).triangles.size(), id % 2 == 0 ? 2u : 1u);
  }
  EXPECT_EQ(scene.name(2), "node 2");
  // The second primitive shares the vertex buffer and keeps only the vertices it uses.
  EXPECT_EQ(scene.mesh_of(1).positions.size(), 3u);
  EXPECT_EQ(scene.mesh_of(1).positions[scene.mesh_of(1).triangles[0].z], glm::vec3(0, 1, 0));
}

TEST(Gltf, DefaultSceneIsTheOneNamedElseTheFirst) {
  GlbFixture fixture = GlbFixture::square();
  fixture.add_node({{"name", "a"}, {"mesh", 0}});
  fixture.add_node({{"name", "b"}, {"mesh", 0}});
  fixture.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1, 0}}}};
  EXPECT_EQ(load_bytes(fixture.glb()).scene.objects().size(), 1u);
  fixture.json["scene"] = 1;
  const Scene scene = load_bytes(fixture.glb()).scene;
  ASSERT_EQ(scene.objects().size(), 2u);
  EXPECT_EQ(scene.name(0), "b");
}

TEST(Gltf, NegativeScaleMirrorsByItsTransform) {
  GlbFixture fixture = GlbFixture::square();
  fixture.add_node({{"mesh", 0}, {"scale", {-1, 1, 1}}});
  const Scene scene = load_bytes(fixture.glb()).scene;
  EXPECT_LT(determinant(scene.objects()[0].transform), 0.0f);
  EXPECT_EQ(scene.meshes()[0].triangles[0], glm::uvec3(0, 1, 2));
}

template <class Index>
void expect_indices_load() {
  GlbFixture fixture;
  const std::size_t points = fixture.add_points({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  fixture.add_mesh(
      {{"attributes", {{"POSITION", points}}}, {"indices", fixture.add_indices<Index>({0, 1, 2, 0, 2, 3})}});
  fixture.add_node({{"mesh", 0}});
  const Scene scene = load_bytes(fixture.glb()).scene;
  ASSERT_EQ(scene.triangle_count(), 2u);
  EXPECT_EQ(scene.meshes()[0].triangles[1], glm::uvec3(0, 2, 3));
}

TEST(Gltf, IndicesOf8Bits) { expect_indices_load<std::uint8_t>(); }
TEST(Gltf, IndicesOf16Bits) { expect_indices_load<std::uint16_t>(); }
TEST(Gltf, IndicesOf32Bits) { expect_indices_load<std::uint32_t>(); }

TEST(Gltf, NonIndexedTriangles) {
  GlbFixture fixture;
  const std::size_t points =
      fixture.add_points({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}, {9, 9, 9}});
  fixture.add_mesh({{"attributes", {{"POSITION", points}}}});
  fixture.add_node({{"mesh", 0}});
  const LoadedScene loaded = load_bytes(fixture.glb());
  EXPECT_EQ(loaded.scene.triangle_count(), 2u);
  EXPECT_EQ(loaded.scene.meshes()[0].positions.size(), 6u);
  ASSERT_EQ(loaded.warnings.size(), 1u);
  EXPECT_NE(loaded.warnings[0].find("meshes[0].primitives[0]: the last corners make no triangle"), std::string::npos);
}

TEST(Gltf, InterleavedVerticesByStrideAndOffset) {
  GlbFixture fixture;
  const std::vector<float> interleaved = {7, 0, 0, 0, 7, 1, 0, 0, 7, 0, 1, 0};
  const std::size_t view = fixture.add_view(std::span(interleaved));
  fixture.json["bufferViews"][view]["byteStride"] = 16;
  const std::size_t points = fixture.add_accessor(view, 5126, "VEC3", 3);
  fixture.json["accessors"][points]["byteOffset"] = 4;
  fixture.add_mesh({{"attributes", {{"POSITION", points}}}});
  fixture.add_node({{"mesh", 0}});
  const Scene scene = load_bytes(fixture.glb()).scene;
  ASSERT_EQ(scene.meshes()[0].positions.size(), 3u);
  EXPECT_EQ(scene.meshes()[0].positions[1], glm::vec3(1, 0, 0));
  EXPECT_EQ(scene.meshes()[0].positions[2], glm::vec3(0, 1, 0));
}

TEST(Gltf, MaterialsThatLetThroughAreNotOpaque) {
  GlbFixture fixture = GlbFixture::square();
  fixture.json["extensionsUsed"] = {"KHR_materials_transmission"};
  fixture.json["materials"] = {{{"alphaMode", "OPAQUE"}},
                               {{"alphaMode", "BLEND"}},
                               {{"alphaMode", "MASK"}},
                               {{"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 0.5}}}}}},
                               {{"extensions", {{"KHR_materials_transmission", json::object()}}}}};
  const json primitive = fixture.json["meshes"][0]["primitives"][0];
  fixture.json["meshes"] = json::array();
  for (int material = 0; material < 5; ++material) {
    json own = primitive;
    own["material"] = material;
    fixture.add_node({{"mesh", fixture.add_mesh(own)}});
  }
  const LoadedScene loaded = load_bytes(fixture.glb());
  const auto objects = loaded.scene.objects();
  ASSERT_EQ(objects.size(), 5u);
  EXPECT_TRUE(objects[0].opaque);
  EXPECT_FALSE(objects[1].opaque);
  EXPECT_FALSE(objects[2].opaque);
  EXPECT_FALSE(objects[3].opaque);
  EXPECT_TRUE(objects[4].opaque);
  // Same geometry under five materials is kept once.
  EXPECT_EQ(loaded.scene.meshes().size(), 1u);
  EXPECT_TRUE(loaded.warnings.empty());
}

TEST(Gltf, DeepHierarchiesNeedNoStack) {
  GlbFixture fixture = GlbFixture::square();
  constexpr int depth = 200000;
  for (int i = 0; i < depth; ++i) {
    json node = {{"translation", {1, 0, 0}}};
    if (i + 1 < depth) {
      node["children"] = {i + 1};
    } else {
      node["mesh"] = 0;
    }
    fixture.add_node(node);
  }
  fixture.json["scenes"] = {{{"nodes", {0}}}};
  const Scene scene = load_bytes(fixture.glb()).scene;
  ASSERT_EQ(scene.objects().size(), 1u);
  EXPECT_EQ(scene.objects()[0].transform[3].x, static_cast<float>(depth));
}

TEST(Gltf, TransformsAreComposedInDouble) {
  GlbFixture fixture = GlbFixture::square();
  fixture.add_node({{"translation", {1e9, 0, 0}}, {"children", {1}}});
  fixture.add_node({{"translation", {-1e9 + 0.125, 0, 0}}, {"mesh", 0}});
  fixture.json["scenes"] = {{{"nodes", {0}}}};
  EXPECT_EQ(load_bytes(fixture.glb()).scene.objects()[0].transform[3].x, 0.125f);
}

std::string base64(std::string_view bytes) {
  const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : alphabet[bits >> (18 - 6 * k) & 63];
  }
  return text;
}

TEST(Gltf, JsonWithDataUri) {
  GlbFixture fixture = GlbFixture::square();
  fixture.add_node({{"mesh", 0}});
  for (const std::size_t extra : {0u, 1u, 2u}) {
    const std::string padded = fixture.binary + std::string(extra, 'x');
    fixture.json["buffers"] = {
        {{"byteLength", fixture.binary.size()}, {"uri", "data:application/octet-stream;base64," + base64(padded)}}};
    EXPECT_EQ(load_bytes(fixture.json_text(), "scene.gltf").scene.triangle_count(), 2u);
  }
  fixture.json["buffers"][0]["uri"] = "data:application/octet-stream;base64,!!!!";
  EXPECT_EQ(load_error(fixture.json_text(), "scene.gltf"),
            "buffers[0].uri: the data URI has a character that is not base64");
}

TEST(Gltf, JsonWithExternalBuffer) {
  GlbFixture fixture = GlbFixture::square();
  fixture.add_node({{"mesh", 0}});
  const ScratchFolder folder;
  folder.write("parts of it/data.bin", fixture.binary);
  fixture.json["buffers"] = {{{"byteLength", fixture.binary.size()}, {"uri", "parts%20of%20it/data.bin"}}};
  const std::filesystem::path file = folder.write("scene.gltf", fixture.json_text());
  EXPECT_EQ(load_scene(file).scene.triangle_count(), 2u);
}

TEST(Gltf, BuffersOutsideTheFolderAreRefused) {
  GlbFixture fixture = GlbFixture::square();
  fixture.add_node({{"mesh", 0}});
  const ScratchFolder folder;
  const std::string secret = folder.write("secret.bin", fixture.binary).string();
  const std::filesystem::path file = folder.path() / "inner" / "scene.gltf";
  for (const std::string& uri :
       {std::string("../secret.bin"), std::string("%2e%2e/secret.bin"), std::string("a/../../secret.bin"), secret,
        "file://" + secret, std::string("http://localhost/secret.bin"), std::string("")}) {
    fixture.json["buffers"] = {{{"byteLength", fixture.binary.size()}, {"uri", uri}}};
    folder.write("inner/scene.gltf", fixture.json_text());
    try {
      load_scene(file);
      ADD_FAILURE() << uri << " was read";
    } catch (const InputError& error) {
      EXPECT_EQ(error.position(), "buffers[0].uri") << error.what();
    }
  }
}

}  // namespace
}  // namespace sightline::test
