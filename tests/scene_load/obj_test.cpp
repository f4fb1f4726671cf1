// What an OBJ file means, and what is wrong in one, by line.
#include "scene_load/glb_fixture.hpp"
#include "sightline/scene/load/load.hpp"

namespace sightline::test {
namespace {

LoadedScene load_text(std::string_view text) { return load_bytes(text, "scene.obj"); }
std::string error_of(std::string_view text) { return load_error(text, "scene.obj"); }

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(Obj, ObjectsAndGroupsBecomeObjects) {
  const Scene scene = load_text(square +
                                "o house\nf 1 2 3\ng door frame\nf 1 3 4\no\ng wall\nf 1 2 4\n"
                                "o house\nf 2 3 4\n")
                          .scene;
  ASSERT_EQ(scene.objects().size(), 3u);
  EXPECT_EQ(scene.name(0), "house");
  EXPECT_EQ(scene.name(1), "house/door frame");
  EXPECT_EQ(scene.name(2), "house/wall") << "a line 'o' without a name is no object line";
  EXPECT_EQ(scene.mesh_of(0).triangles.size(), 2u) << "faces of the same names are one object, wherever they stand";
  EXPECT_EQ(scene.mesh_of(0).positions.size(), 4u);
  EXPECT_EQ(scene.mesh_of(1).positions.size(), 3u);
}

TEST(Obj, AllKindsOfCorners) {
  const std::string normals = "vt 0 0\nvn 0 0 1\n";
  for (const char* face : {"f 1 2 3", "f 1/1 2/1 3/1", "f 1//1 2//1 3//1", "f 1/1/1 2/1/1 3/1/1", "f -4 -3 -2",
                           "f -4/-1/-1 -3/-1/-1 -2/-1/-1", "f  1\t2  3 \r", "f 1 \\\n2 \\\r\n3"}) {
    const Scene scene = load_text(square + normals + face + "\n").scene;
    ASSERT_EQ(scene.triangle_count(), 1u) << face;
    EXPECT_EQ(scene.meshes()[0].positions[2], glm::vec3(1, 1, 0)) << face;
  }
}

TEST(Obj, AnyEndOfLine) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    const Scene scene = load_text("v 0 0 0" + end + "v 1 0 0" + end + end + "v 0 1 0" + end + "f 1 2 3").scene;
    const std::vector<glm::vec3> expected = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    EXPECT_EQ(corners_of(scene), expected);
    EXPECT_EQ(error_of("v 0 0 0" + end + end + "v 1 0 x" + end), "line 3: a vertex needs three numbers");
  }
}

TEST(Obj, PolygonsAreTriangulated) {
  // An L of area 3, concave at its fifth corner.
  const Scene scene = load_text("v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5 6\n").scene;
  const Mesh& mesh = scene.meshes()[0];
  ASSERT_EQ(mesh.triangles.size(), 4u);
  float area = 0.0f;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
    const float part = 0.5f * glm::cross(b - a, c - a).z;
    EXPECT_GE(part, 0.0f);
    area += part;
  }
  EXPECT_FLOAT_EQ(area, 3.0f);
}

TEST(Obj, CoordinatesAreRoundedOnce) {
  const Scene scene =
      load_text("v 0.1 1.00000005960464477539062500001 -1e-3\nv +1 0 0 1.0\nv 0 1 0 0.5 0.5 0.5\nf 1 2 3\n").scene;
  EXPECT_EQ(scene.meshes()[0].positions[0], glm::vec3(0.1f, 1.0f, -1e-3f));
}

TEST(Obj, MaterialsThatLetThroughAreObjectsOfTheirOwn) {
  const ScratchFolder folder;
  folder.write("materials.mtl", "newmtl wall\nKd 1 1 1\nd 1.0\nnewmtl glass\nd 0.25\n");
  folder.write("more.mtl", "newmtl fence\nmap_d fence.png\nnewmtl haze\nTr 0.75\n");
  const LoadedScene loaded =
      load_scene(folder.write("scene.obj", "mtllib materials.mtl more.mtl\n" + square +
                                               "usemtl glass\nf 1 2 3\nusemtl wall\nf 1 3 4\nusemtl fence\nf 1 2 "
                                               "4\nusemtl haze\nf 1 2 4\nusemtl other\nf 2 3 4\n"));
  const Scene& scene = loaded.scene;
  ASSERT_EQ(scene.objects().size(), 2u);
  EXPECT_TRUE(scene.objects()[0].opaque);
  EXPECT_EQ(scene.mesh_of(0).triangles.size(), 2u);
  EXPECT_FALSE(scene.objects()[1].opaque);
  EXPECT_EQ(scene.mesh_of(1).triangles.size(), 3u);
  EXPECT_EQ(scene.source(1).primitive, 1);
  EXPECT_EQ(loaded.warnings, std::vector<std::string>{"material 'other' is not known, taken as opaque"});
}

TEST(Obj, MaterialFilesOutsideTheFolderAreNotRead) {
  const ScratchFolder folder;
  folder.write("glass.mtl", "newmtl glass\nd 0.25\n");
  const std::string text = "mtllib ../glass.mtl\n" + square + "usemtl glass\nf 1 2 3\n";
  const LoadedScene loaded = load_scene(folder.write("inner/scene.obj", text));
  EXPECT_TRUE(loaded.scene.objects()[0].opaque);
  ASSERT_EQ(loaded.warnings.size(), 2u);
  EXPECT_EQ(loaded.warnings[0], "material file '../glass.mtl' lies outside the folder of the scene, not read");
}

TEST(Obj, MissingMaterialFileIsAWarning) {
  const LoadedScene loaded = load_text("mtllib none.mtl\n" + square + "f 1 2 3\n");
  EXPECT_EQ(loaded.warnings, std::vector<std::string>{"material file 'none.mtl' no such file"});
}

TEST(Obj, LinesAndPointsAreAWarning) {
  const LoadedScene loaded = load_text(square + "l 1 2\np 1\nf 1 2 3\n");
  EXPECT_EQ(loaded.warnings, std::vector<std::string>{"2 points, lines, curves and surfaces are left out"});
}

TEST(Obj, ErrorsNameTheLine) {
  EXPECT_EQ(error_of("v 0 0 0\nv 1 x 0\n"), "line 2: a vertex needs three numbers");
  EXPECT_EQ(error_of("v 0 0\n"), "line 1: a vertex needs three numbers");
  EXPECT_EQ(error_of("v 0 0 1.5abc\n"), "line 1: a vertex needs three numbers");
  EXPECT_EQ(error_of("v 0 0 nan\n"), "line 1: a coordinate is not finite");
  EXPECT_EQ(error_of("v 0 0 1e39\n"), "line 1: a coordinate is not finite");
  EXPECT_EQ(error_of("v 0 0 1e999\n"), "line 1: a coordinate is not finite");
  EXPECT_EQ(error_of(square + "# one\n\\\nf 1 2 \\\n 5\n"), "line 6: vertex 5 is not among the 4 so far");
  EXPECT_EQ(error_of(square + "f 1 2 -5\n"), "line 5: vertex -5 is not among the 4 so far");
  EXPECT_EQ(error_of(square + "f 1 2 2147483648\n"), "line 5: vertex 2147483648 is not among the 4 so far");
  EXPECT_EQ(error_of(square + "f 1 2 4294967297\n"), "line 5: vertex 4294967297 is not among the 4 so far");
  EXPECT_EQ(error_of(square + "f 1 2 0\n"), "line 5: '0' is no vertex number");
  EXPECT_EQ(error_of(square + "f a b c\n"), "line 5: 'a' is no vertex number");
  EXPECT_EQ(error_of(square + "f 1 2\n"), "line 5: a face needs three corners");
  EXPECT_EQ(error_of(""), ": is empty");
  EXPECT_EQ(error_of(square + "f 1 2 3x\n"), "line 5: '3x' is no vertex number");
  EXPECT_EQ(error_of(square + "f 1 2 99999999999999999999\n"), "line 5: '99999999999999999999' is no vertex number");
  EXPECT_EQ(error_of("hello\n"), ": has no faces");
  EXPECT_EQ(error_of(std::string("v 0 0 0\n\0", 9)), "byte 8: is no text");
}

}  // namespace
}  // namespace sightline::test
