// Saving and loading a GLB gives the same scene.
#include <sys/stat.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <thread>

#include "scene_load/glb_fixture.hpp"
#include "sightline/scene/save/glb.hpp"

namespace sightline::test {
namespace {

Mesh tetrahedron(const std::string& name, float size) {
  Mesh mesh;
  mesh.name = name;
  mesh.positions = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

void expect_same_objects(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.objects().size(), b.objects().size());
  for (ObjectId id = 0; id < a.objects().size(); ++id) {
    EXPECT_EQ(a.name(id), b.name(id));
    EXPECT_EQ(a.objects()[id].transform, b.objects()[id].transform);
    EXPECT_EQ(a.objects()[id].opaque, b.objects()[id].opaque);
    EXPECT_EQ(a.objects()[id].bounds, b.objects()[id].bounds);
    EXPECT_EQ(a.mesh_of(id).name, b.mesh_of(id).name);
    EXPECT_EQ(a.mesh_of(id).closed, b.mesh_of(id).closed);
    EXPECT_EQ(a.mesh_of(id).positions, b.mesh_of(id).positions);
    EXPECT_EQ(a.mesh_of(id).triangles, b.mesh_of(id).triangles);
  }
}

TEST(SaveGlb, RoundTripKeepsObjectsBitByBit) {
  SceneBuilder builder;
  const MeshId small = builder.add_mesh(tetrahedron("small", 1.0f / 3.0f));
  const MeshId large = builder.add_mesh(tetrahedron("large \"quoted\" \\ \u00fc \n line", 7.1e-20f));
  Affine turned(0.36f, 0.48f, -0.8f, -0.8f, 0.6f, 0.0f, 0.48f, 0.64f, 0.6f, 1e-7f, 123456.789f, -3.0f);
  builder.add_object(small, identity_affine(), "a");
  builder.add_object(large, turned, "b/\"c\"");
  builder.add_object(small, turned, "glass", {}, false);
  builder.add_object(small, Affine(-1.0f), "mirrored");
  const Scene scene = builder.build();
  const ScratchFolder folder;
  save_glb(scene, folder.path() / "scene.glb");
  const LoadedScene loaded = load_scene(folder.path() / "scene.glb");
  expect_same_objects(scene, loaded.scene);
  EXPECT_EQ(loaded.scene.meshes().size(), 2u) << "shared meshes are written once";
  EXPECT_TRUE(loaded.warnings.empty());
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1) << "no temporary file is left";
}

TEST(SaveGlb, MeshesBeyond65535VerticesGet32BitIndices) {
  Mesh strip;
  strip.name = "strip";
  for (std::uint32_t i = 0; i < 70001; ++i)
    strip.positions.emplace_back(static_cast<float>(i / 2), static_cast<float>(i % 2), 0.0f);
  for (std::uint32_t i = 0; i + 2 < 70001; ++i) strip.triangles.emplace_back(i, i + 1 + i % 2, i + 2 - i % 2);
  SceneBuilder builder;
  builder.add_object(builder.add_mesh(std::move(strip)), identity_affine(), "strip");
  builder.add_object(builder.add_mesh(tetrahedron("tetrahedron", 1.0f)), identity_affine(), "tetrahedron");
  const Scene scene = builder.build();
  const ScratchFolder folder;
  save_glb(scene, folder.path() / "scene.glb");
  expect_same_objects(scene, load_scene(folder.path() / "scene.glb").scene);
}

TEST(SaveGlb, EmptySceneIsAFileToo) {
  const ScratchFolder folder;
  save_glb(SceneBuilder().build(), folder.path() / "scene.glb");
  EXPECT_TRUE(load_scene(folder.path() / "scene.glb").scene.objects().empty());
}

TEST(SaveGlb, UnwritablePlacesAreInputErrors) {
  const Scene scene = SceneBuilder().build();
  const ScratchFolder folder;
  EXPECT_THROW(save_glb(scene, folder.path() / "no such folder" / "scene.glb"), InputError);
  EXPECT_THROW(save_glb(scene, folder.path()), InputError);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(SaveGlb, KeepsLinksAndWritesIntoPipes) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / ("sightline_links_" + std::to_string(getpid()));
  fs::create_directories(folder);
  const Scene scene = SceneBuilder().build();
  save_glb(scene, folder / "target.glb");
  fs::create_symlink(folder / "target.glb", folder / "link.glb");
  save_glb(scene, folder / "link.glb");
  EXPECT_TRUE(fs::is_symlink(folder / "link.glb"));
  EXPECT_TRUE(fs::is_regular_file(folder / "target.glb"));
  ASSERT_EQ(mkfifo((folder / "pipe.glb").c_str(), 0600), 0);
  std::string piped;
  std::thread reader([&] {
    std::ifstream pipe(folder / "pipe.glb", std::ios::binary);
    piped.assign(std::istreambuf_iterator<char>(pipe), {});
  });
  save_glb(scene, folder / "pipe.glb");
  reader.join();
  std::ifstream target(folder / "target.glb", std::ios::binary);
  EXPECT_EQ(piped, std::string(std::istreambuf_iterator<char>(target), {}));
  EXPECT_TRUE(fs::is_fifo(folder / "pipe.glb"));
  fs::remove_all(folder);
}

}  // namespace
}  // namespace sightline::test
