// Compressed glTF: meshes encoded by meshoptimizer and Draco themselves come back as they were.
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "scene_load/glb_fixture.hpp"

namespace sightline::test {
namespace {

using nlohmann::json;

// A grid of 20 x 20 vertices with a wave, large enough that the codecs do real work.
struct Grid {
  std::vector<glm::vec3> points;
  std::vector<std::uint32_t> indices;
  Grid() {
    constexpr std::uint32_t n = 20;
    for (std::uint32_t i = 0; i < n * n; ++i) {
      points.emplace_back(i % n, std::sin(0.3f * static_cast<float>(i)), i / n);
    }
    for (std::uint32_t i = 0; i < n * (n - 1); ++i) {
      if (i % n == n - 1) continue;
      indices.insert(indices.end(), {i, i + n, i + 1, i + 1, i + n, i + n + 1});
    }
  }
  [[nodiscard]] std::vector<glm::vec3> corners() const {
    std::vector<glm::vec3> result;
    for (const std::uint32_t i : indices) result.push_back(points[i]);
    return result;
  }
};

std::size_t add_meshopt_view(GlbFixture& fixture, const std::vector<unsigned char>& encoded, std::size_t count,
                             std::size_t stride, const std::string& mode, const std::string& filter = "NONE") {
  const std::size_t view = fixture.add_view(std::span(encoded));
  json& entry = fixture.json["bufferViews"][view];
  entry["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},
                                                    {"byteOffset", entry["byteOffset"]},
                                                    {"byteLength", encoded.size()},
                                                    {"byteStride", stride},
                                                    {"count", count},
                                                    {"mode", mode},
                                                    {"filter", filter}};
  // The view itself is that of a fallback buffer that is not in the file.
  entry["buffer"] = 1;
  entry["byteOffset"] = 0;
  entry["byteLength"] = count * stride;
  fixture.json["buffers"] = {
      {{"byteLength", fixture.binary.size()}},
      {{"byteLength", count * stride}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
  return view;
}

std::vector<unsigned char> encode_vertices(const void* data, std::size_t count, std::size_t stride) {
  std::vector<unsigned char> encoded(meshopt_encodeVertexBufferBound(count, stride));
  encoded.resize(meshopt_encodeVertexBuffer(encoded.data(), encoded.size(), data, count, stride));
  return encoded;
}

std::vector<unsigned char> encode_triangles(const std::vector<std::uint32_t>& indices, std::size_t vertices) {
  std::vector<unsigned char> encoded(meshopt_encodeIndexBufferBound(indices.size(), vertices));
  encoded.resize(meshopt_encodeIndexBuffer(encoded.data(), encoded.size(), indices.data(), indices.size()));
  return encoded;
}

GlbFixture meshopt_grid(const Grid& grid) {
  GlbFixture fixture;
  fixture.json["extensionsUsed"] = fixture.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  const auto vertices = encode_vertices(grid.points.data(), grid.points.size(), 12);
  const std::size_t points = fixture.add_accessor(
      add_meshopt_view(fixture, vertices, grid.points.size(), 12, "ATTRIBUTES"), 5126, "VEC3", grid.points.size());
  const auto triangles = encode_triangles(grid.indices, grid.points.size());
  const std::size_t indices = fixture.add_accessor(
      add_meshopt_view(fixture, triangles, grid.indices.size(), 2, "TRIANGLES"), 5123, "SCALAR", grid.indices.size());
  fixture.add_mesh({{"attributes", {{"POSITION", points}}}, {"indices", indices}});
  fixture.add_node({{"mesh", 0}});
  return fixture;
}

/// Triangles as sets of corners: codecs may begin a triangle at another corner and reorder triangles.
std::vector<std::array<float, 9>> canonical(const std::vector<glm::vec3>& corners) {
  std::vector<std::array<float, 9>> triangles;
  const auto less = [](const glm::vec3& a, const glm::vec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    std::array<glm::vec3, 3> t = {corners[i], corners[i + 1], corners[i + 2]};
    std::rotate(t.begin(), std::min_element(t.begin(), t.end(), less), t.end());
    triangles.push_back({t[0].x, t[0].y, t[0].z, t[1].x, t[1].y, t[1].z, t[2].x, t[2].y, t[2].z});
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

TEST(GltfMeshopt, AttributesAndTriangles) {
  const Grid grid;
  const LoadedScene loaded = load_bytes(meshopt_grid(grid).glb());
  EXPECT_EQ(canonical(corners_of(loaded.scene)), canonical(grid.corners()));
  EXPECT_TRUE(loaded.warnings.empty());
}

TEST(GltfMeshopt, IndexSequence) {
  const Grid grid;
  GlbFixture fixture = meshopt_grid(grid);
  for (const std::size_t size : {2u, 4u}) {
    std::vector<unsigned char> encoded(meshopt_encodeIndexSequenceBound(grid.indices.size(), grid.points.size()));
    encoded.resize(
        meshopt_encodeIndexSequence(encoded.data(), encoded.size(), grid.indices.data(), grid.indices.size()));
    const std::size_t view = add_meshopt_view(fixture, encoded, grid.indices.size(), size, "INDICES");
    fixture.json["accessors"][1]["bufferView"] = view;
    fixture.json["accessors"][1]["componentType"] = size == 2 ? 5123 : 5125;
    EXPECT_EQ(corners_of(load_bytes(fixture.glb()).scene), grid.corners());
  }
}

TEST(GltfMeshopt, ExponentialFilter) {
  const Grid grid;
  GlbFixture fixture = meshopt_grid(grid);
  std::vector<std::int32_t> filtered(grid.points.size() * 3);
  meshopt_encodeFilterExp(filtered.data(), grid.points.size(), 12, 20, &grid.points[0].x);
  const auto encoded = encode_vertices(filtered.data(), grid.points.size(), 12);
  fixture.json["accessors"][0]["bufferView"] =
      add_meshopt_view(fixture, encoded, grid.points.size(), 12, "ATTRIBUTES", "EXPONENTIAL");
  const std::vector<glm::vec3> positions = load_bytes(fixture.glb()).scene.meshes()[0].positions;
  ASSERT_EQ(positions.size(), grid.points.size());
  for (std::size_t i = 0; i < positions.size(); ++i) EXPECT_LT(glm::distance(positions[i], grid.points[i]), 1e-4f);
}

TEST(GltfMeshopt, QuaternionFilterForInstances) {
  GlbFixture fixture = GlbFixture::square();
  std::vector<glm::vec4> turns;
  for (int i = 0; i < 10; ++i) {
    const glm::quat q = glm::angleAxis(0.5f * static_cast<float>(i), glm::normalize(glm::vec3(1, 2, 3)));
    turns.emplace_back(q.x, q.y, q.z, q.w);
  }
  std::vector<std::int16_t> filtered(turns.size() * 4);
  meshopt_encodeFilterQuat(filtered.data(), turns.size(), 8, 16, &turns[0].x);
  const auto encoded = encode_vertices(filtered.data(), turns.size(), 8);
  const std::size_t view = add_meshopt_view(fixture, encoded, turns.size(), 8, "ATTRIBUTES", "QUATERNION");
  const std::size_t rotations = fixture.add_accessor(view, 5122, "VEC4", turns.size());
  fixture.json["accessors"][rotations]["normalized"] = true;
  fixture.add_node(
      {{"mesh", 0}, {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"ROTATION", rotations}}}}}}}});
  const Scene scene = load_bytes(fixture.glb()).scene;
  ASSERT_EQ(scene.objects().size(), turns.size());
  for (std::size_t i = 0; i < turns.size(); ++i) {
    const glm::quat q(turns[i].w, turns[i].x, turns[i].y, turns[i].z);
    EXPECT_LT(glm::distance(transform_point(scene.objects()[i].transform, {1, 0, 0}), q * glm::vec3(1, 0, 0)), 1e-3f);
  }
}

TEST(GltfMeshopt, BrokenViewsAreInputErrors) {
  const std::string place = "bufferViews[0].extensions.EXT_meshopt_compression";
  const auto error_with = [](const std::string& field, const json& value) {
    GlbFixture fixture = meshopt_grid(Grid());
    fixture.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"][field] = value;
    return load_error(fixture.glb());
  };
  EXPECT_EQ(error_with("byteStride", 10), place + ": mode, filter, count and byteStride do not go together");
  EXPECT_EQ(error_with("byteStride", 1024), place + ".byteStride: 1024 is more than 256");
  EXPECT_EQ(error_with("mode", "NEW"), place + ": mode, filter, count and byteStride do not go together");
  EXPECT_EQ(error_with("filter", "OCTAHEDRAL"), place + ": mode, filter, count and byteStride do not go together");
  EXPECT_EQ(error_with("mode", "TRIANGLES"), place + ": mode, filter, count and byteStride do not go together");
  EXPECT_EQ(error_with("count", 4000000000u), place + ": the file asks for more than 1024 MiB");
  EXPECT_NE(error_with("count", 4000).find("the compressed data is broken"), std::string::npos);
  EXPECT_NE(error_with("byteLength", 7).find("the compressed data is broken"), std::string::npos);
  EXPECT_NE(error_with("byteLength", 1u << 30).find("lie outside buffers[0]"), std::string::npos);
  GlbFixture fixture = meshopt_grid(Grid());
  fixture.json["accessors"][0]["count"] = 401;
  EXPECT_EQ(load_error(fixture.glb()), "accessors[0]: 401 elements need 4812 bytes, the buffer view has 4800");
}

std::vector<char> encode_draco(const Grid& grid, int method, bool with_normals) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(static_cast<int>(grid.indices.size() / 3));
  const int positions = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int normals = with_normals ? builder.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32) : -1;
  for (std::size_t i = 0; i < grid.indices.size(); i += 3) {
    const draco::FaceIndex face(static_cast<std::uint32_t>(i / 3));
    builder.SetAttributeValuesForFace(positions, face, &grid.points[grid.indices[i]].x,
                                      &grid.points[grid.indices[i + 1]].x, &grid.points[grid.indices[i + 2]].x);
    // A normal for each face: corners at the same place differ.
    const float normal[3] = {static_cast<float>(i), 1.0f, 0.0f};
    if (with_normals) builder.SetAttributeValuesForFace(normals, face, normal, normal, normal);
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(method);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 16);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, 8);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  return {buffer.data(), buffer.data() + buffer.size()};
}

GlbFixture draco_grid(const std::vector<char>& encoded, const Grid& grid) {
  GlbFixture fixture;
  fixture.json["extensionsUsed"] = fixture.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  const std::size_t view = fixture.add_view(std::span(encoded));
  fixture.json["accessors"] = {{{"componentType", 5126}, {"type", "VEC3"}, {"count", grid.points.size()}},
                               {{"componentType", 5125}, {"type", "SCALAR"}, {"count", grid.indices.size()}}};
  fixture.add_mesh(
      {{"attributes", {{"POSITION", 0}}},
       {"indices", 1},
       {"extensions", {{"KHR_draco_mesh_compression", {{"bufferView", view}, {"attributes", {{"POSITION", 0}}}}}}}});
  fixture.add_node({{"mesh", 0}});
  return fixture;
}

TEST(GltfDraco, BothMethodsGiveTheMesh) {
  const Grid grid;
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    for (const bool with_normals : {false, true}) {
      const LoadedScene loaded = load_bytes(draco_grid(encode_draco(grid, method, with_normals), grid).glb());
      EXPECT_TRUE(loaded.warnings.empty());
      const Mesh& mesh = loaded.scene.meshes()[0];
      if (!with_normals) {
        EXPECT_EQ(mesh.positions.size(), grid.points.size());
      }
      // Positions are quantised, so they are matched to the grid by rounding x and z, which are integers.
      std::vector<glm::vec3> corners = corners_of(loaded.scene);
      for (glm::vec3& corner : corners) {
        const glm::vec3& original =
            grid.points[static_cast<std::size_t>(std::lround(corner.z) * 20 + std::lround(corner.x))];
        EXPECT_LT(glm::distance(corner, original), 1e-3f);
        corner = original;
      }
      EXPECT_EQ(canonical(corners), canonical(grid.corners()));
    }
  }
}

TEST(GltfDraco, BrokenDataIsAnInputError) {
  const Grid grid;
  const std::vector<char> encoded = encode_draco(grid, draco::MESH_EDGEBREAKER_ENCODING, false);
  const std::string place = "meshes[0].primitives[0].extensions.KHR_draco_mesh_compression";
  GlbFixture fixture = draco_grid(encoded, grid);
  json& extension = fixture.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"];
  extension["attributes"]["POSITION"] = 5;
  EXPECT_EQ(load_error(fixture.glb()), place + ".attributes.POSITION: the compressed mesh has no such attribute");
  extension["attributes"] = json::object();
  EXPECT_EQ(load_error(fixture.glb()), place + ".attributes.POSITION: is missing");
  extension["bufferView"] = 9;
  EXPECT_EQ(load_error(fixture.glb()), place + ".bufferView: there is no entry 9, only 1");
  const std::vector<char> half(encoded.begin(), encoded.begin() + static_cast<std::ptrdiff_t>(encoded.size() / 2));
  EXPECT_NE(load_error(draco_grid(half, grid).glb()).find(place + ": the compressed data is broken"),
            std::string::npos);
}

}  // namespace
}  // namespace sightline::test
