// The formats that come through assimp: what arrives, in which units and axes, and what is said to be dropped.
// Files are made by assimp's exporters, or by hand where it has none (IFC) or where the axes matter (FBX, DAE).
#include <assimp/scene.h>

#include <assimp/Exporter.hpp>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iterator>
#include <new>
#include <stdexcept>

#include "scene_load/fbx_fixture.hpp"
#include "scene_load/glb_fixture.hpp"
#include "sightline/scene/load/child_process.hpp"
#include "sightline/scene/load/load.hpp"

namespace sightline::test {
namespace {

/// A tetrahedron with corners 0, x, y, z used by two nodes: "left" as it is, "right" moved by (10, 20, 30).
std::unique_ptr<aiScene> two_tetrahedra() {
  auto scene = std::make_unique<aiScene>();
  auto* mesh = new aiMesh;
  mesh->mName = "tetrahedron";
  mesh->mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
  mesh->mNumVertices = 4;
  mesh->mVertices = new aiVector3D[4]{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh->mNormals = new aiVector3D[4]{{0, 0, -1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh->mNumFaces = 4;
  mesh->mFaces = new aiFace[4];
  const unsigned int corners[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  for (int face = 0; face < 4; ++face) {
    mesh->mFaces[face].mNumIndices = 3;
    mesh->mFaces[face].mIndices = new unsigned int[3]{corners[face][0], corners[face][1], corners[face][2]};
  }
  scene->mNumMeshes = 1;
  scene->mMeshes = new aiMesh*[1]{mesh};
  scene->mNumMaterials = 1;
  scene->mMaterials = new aiMaterial*[1]{new aiMaterial};
  scene->mRootNode = new aiNode("root");
  auto* left = new aiNode("left");
  auto* right = new aiNode("right");
  right->mTransformation = aiMatrix4x4(1, 0, 0, 10, 0, 1, 0, 20, 0, 0, 1, 30, 0, 0, 0, 1);
  for (aiNode* node : {left, right}) {
    node->mNumMeshes = 1;
    node->mMeshes = new unsigned int[1]{0};
  }
  aiNode* children[2] = {left, right};
  scene->mRootNode->addChildren(2, children);
  return scene;
}

LoadedScene export_and_load(const char* format, const std::string& name) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / name;
  Assimp::Exporter exporter;
  EXPECT_EQ(exporter.Export(two_tetrahedra().get(), format, file.string()), aiReturn_SUCCESS)
      << exporter.GetErrorString();
  return load_scene(file);
}

void expect_bounds(const Aabb& box, const Aabb& expected) {
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(box.lo[axis], expected.lo[axis], 1e-3f);
    EXPECT_NEAR(box.hi[axis], expected.hi[axis], 1e-3f);
  }
}

TEST(Assimp, PlyAndStlAreOneMesh) {
  for (const auto& [format, name] :
       {std::pair("ply", "a.ply"), {"plyb", "b.ply"}, {"stl", "a.stl"}, {"stlb", "b.STL"}}) {
    const LoadedScene loaded = export_and_load(format, name);
    EXPECT_EQ(loaded.scene.triangle_count(), 8u) << name;
    expect_bounds(loaded.scene.bounds(), {{0, 0, 0}, {11, 21, 31}});
    EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings[0];
    for (const Mesh& mesh : loaded.scene.meshes()) {
      EXPECT_TRUE(mesh.closed) << name << ": the way round of the triangles is kept";
      EXPECT_EQ(mesh.positions.size(), mesh.triangles.size()) << name << ": equal vertices are joined";
    }
  }
}

TEST(Assimp, HierarchiesKeepNamesAndSharedMeshes) {
  for (const auto& [format, name] : {std::pair("collada", "a.dae"), {"fbxa", "b.fbx"}}) {
    const LoadedScene loaded = export_and_load(format, name);
    const Scene& scene = loaded.scene;
    ASSERT_EQ(scene.objects().size(), 2u) << name;
    EXPECT_EQ(scene.meshes().size(), 1u) << name;
    EXPECT_EQ(scene.name(0), "left") << name;
    EXPECT_EQ(scene.name(1), "right") << name;
    EXPECT_EQ(scene.triangle_count(), 8u) << name;
    EXPECT_TRUE(scene.objects()[0].opaque) << name;
  }
}

TEST(Assimp, FbxIsTurnedAndScaledToMetres) {
  const Aabb y_up{{10, 20, 30}, {11, 21, 31}};
  const Aabb z_up{{10, 30, -21}, {11, 31, -20}};
  for (const bool z : {false, true}) {
    const std::vector<FbxNode> metres = fbx_tetrahedron(z, 100.0), inches = fbx_tetrahedron(z, 2.54);
    const Aabb& expected = z ? z_up : y_up;
    expect_bounds(load_bytes(fbx_text(metres), "a.fbx").scene.bounds(), expected);
    const Scene scene = load_bytes(FbxBinary(metres).bytes(), "a.fbx").scene;
    expect_bounds(scene.bounds(), expected);
    EXPECT_TRUE(scene.meshes()[0].closed);
    EXPECT_GT(determinant(scene.objects()[0].transform), 0.0f);
    expect_bounds(load_bytes(FbxBinary(inches).bytes(), "a.fbx").scene.bounds(),
                  {0.0254f * expected.lo, 0.0254f * expected.hi});
  }
}

TEST(Assimp, ColladaIsTurnedAndScaledToMetres) {
  expect_bounds(export_and_load("collada", "a.dae").scene.bounds(), {{0, 0, 0}, {11, 21, 31}});
  const LoadedScene loaded = load_bytes(R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="inch" meter="0.0254"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g" name="g"><mesh>
<source id="p"><float_array id="a" count="9">0 0 0 100 0 0 0 200 300</float_array><technique_common>
<accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor>
</technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)",
                                        "a.dae");
  expect_bounds(loaded.scene.bounds(), {{0, 0, -5.08f}, {2.54f, 7.62f, 0}});
}

std::string chunk_3ds(std::uint16_t id, const std::string& content) {
  std::string bytes(2, '\0');
  std::memcpy(bytes.data(), &id, 2);
  return bytes + word(static_cast<std::uint32_t>(6 + content.size())) + content;
}

template <class Number>
std::string counted_3ds(std::size_t count, const std::vector<Number>& numbers) {
  const auto size = static_cast<std::uint16_t>(count);
  return std::string(reinterpret_cast<const char*>(&size), 2) +
         std::string(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number));
}

TEST(Assimp, ThreeDsIsTurned) {
  const std::string mesh = chunk_3ds(0x4110, counted_3ds<float>(3, {0, 0, 0, 1, 0, 0, 0, 2, 3})) +
                           chunk_3ds(0x4120, counted_3ds<std::uint16_t>(1, {0, 1, 2, 7}));
  const std::string object = chunk_3ds(0x4000, std::string("wall\0", 5) + chunk_3ds(0x4100, mesh));
  const LoadedScene loaded = load_bytes(chunk_3ds(0x4D4D, chunk_3ds(0x3D3D, object)), "a.3ds");
  ASSERT_EQ(loaded.scene.objects().size(), 1u);
  expect_bounds(loaded.scene.bounds(), {{0, 0, -2}, {1, 3, 0}});
}

/// A box of 2 x 4 x 6 m that stands at (1, 2, 3) m, Z up, in millimetres.
const char* const ifc_box = R"(ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('','',(''),(''),'','','');
FILE_SCHEMA(('IFC2X3'));
ENDSEC;
DATA;
#1=IFCSIUNIT(*,.LENGTHUNIT.,.MILLI.,.METRE.);
#3=IFCUNITASSIGNMENT((#1));
#4=IFCCARTESIANPOINT((0.,0.,0.));
#5=IFCDIRECTION((0.,0.,1.));
#6=IFCDIRECTION((1.,0.,0.));
#7=IFCAXIS2PLACEMENT3D(#4,#5,#6);
#8=IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-05,#7,$);
#9=IFCPERSON($,'x',$,$,$,$,$,$);
#10=IFCORGANIZATION($,'x',$,$,$);
#11=IFCPERSONANDORGANIZATION(#9,#10,$);
#12=IFCAPPLICATION(#10,'1','x','x');
#13=IFCOWNERHISTORY(#11,#12,$,.ADDED.,$,$,$,0);
#14=IFCPROJECT('0YvctVUKr0kugbFTf53O9L',#13,'project',$,$,$,$,(#8),#3);
#15=IFCLOCALPLACEMENT($,#7);
#16=IFCSITE('1YvctVUKr0kugbFTf53O9L',#13,'site',$,$,#15,$,$,.ELEMENT.,$,$,$,$,$);
#17=IFCRELAGGREGATES('2YvctVUKr0kugbFTf53O9L',#13,$,$,#14,(#16));
#20=IFCCARTESIANPOINT((1000.,2000.,3000.));
#21=IFCAXIS2PLACEMENT3D(#20,#5,#6);
#22=IFCLOCALPLACEMENT(#15,#21);
#23=IFCCARTESIANPOINT((1000.,2000.));
#24=IFCDIRECTION((1.,0.));
#25=IFCAXIS2PLACEMENT2D(#23,#24);
#26=IFCRECTANGLEPROFILEDEF(.AREA.,$,#25,2000.,4000.);
#27=IFCEXTRUDEDAREASOLID(#26,#7,#5,6000.);
#28=IFCSHAPEREPRESENTATION(#8,'Body','SweptSolid',(#27));
#29=IFCPRODUCTDEFINITIONSHAPE($,$,(#28));
#30=IFCBUILDINGELEMENTPROXY('3YvctVUKr0kugbFTf53O9L',#13,'box',$,$,#22,#29,$,$);
#31=IFCRELCONTAINEDINSPATIALSTRUCTURE('4YvctVUKr0kugbFTf53O9L',#13,$,$,(#30),#16);
ENDSEC;
END-ISO-10303-21;
)";

TEST(Assimp, IfcIsTurnedAndScaledToMetres) {
  const LoadedScene loaded = load_bytes(ifc_box, "a.ifc");
  ASSERT_EQ(loaded.scene.objects().size(), 1u);
  EXPECT_NE(loaded.scene.name(0).find("box"), std::string::npos) << loaded.scene.name(0);
  EXPECT_EQ(loaded.scene.triangle_count(), 12u);
  EXPECT_TRUE(loaded.scene.meshes()[0].closed);
  expect_bounds(loaded.scene.bounds(), {{1, 3, -6}, {3, 9, -2}});
}

TEST(Assimp, PointCloudsAreSaidToBeLeftOut) {
  const std::string points =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 "
      "0\n1 1 1\n";
  const LoadedScene loaded = load_bytes(points, "a.ply");
  EXPECT_TRUE(loaded.scene.objects().empty());
  EXPECT_EQ(loaded.warnings, std::vector<std::string>{"1 meshes of points or lines are left out"});
}

TEST(Assimp, WhatIsNotUsedIsSaid) {
  const std::unique_ptr<aiScene> scene = two_tetrahedra();
  scene->mNumCameras = 1;
  scene->mCameras = new aiCamera*[1]{new aiCamera};
  scene->mCameras[0]->mName = "eye";
  scene->mNumLights = 1;
  scene->mLights = new aiLight*[1]{new aiLight};
  scene->mLights[0]->mName = "lamp";
  scene->mLights[0]->mType = aiLightSource_POINT;
  aiNode* children[2] = {new aiNode("eye"), new aiNode("lamp")};
  scene->mRootNode->addChildren(2, children);
  auto* channel = new aiNodeAnim;
  channel->mNodeName = "left";
  channel->mNumPositionKeys = channel->mNumRotationKeys = channel->mNumScalingKeys = 1;
  channel->mPositionKeys = new aiVectorKey[1]{{0.0, {0, 0, 0}}};
  channel->mRotationKeys = new aiQuatKey[1]{{0.0, aiQuaternion()}};
  channel->mScalingKeys = new aiVectorKey[1]{{0.0, {1, 1, 1}}};
  scene->mNumAnimations = 1;
  scene->mAnimations = new aiAnimation*[1]{new aiAnimation};
  scene->mAnimations[0]->mNumChannels = 1;
  scene->mAnimations[0]->mChannels = new aiNodeAnim*[1]{channel};
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "a.dae";
  Assimp::Exporter exporter;
  ASSERT_EQ(exporter.Export(scene.get(), "collada", file.string()), aiReturn_SUCCESS) << exporter.GetErrorString();
  const std::vector<std::string> expected = {"1 animations are not used", "1 lights are not used",
                                             "1 cameras are not used"};
  EXPECT_EQ(load_scene(file).warnings, expected);
}

/// A scene or an error of one line about this file; never anything else.
void expect_scene_or_one_line(const std::string& bytes, const std::string& name, const std::string& what) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.write(name, bytes);
  try {
    load_scene(file);
  } catch (const InputError& error) {
    EXPECT_EQ(error.file(), file.string()) << what;
    EXPECT_FALSE(error.reason().empty()) << what;
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << what;
  }
}

std::string exported(const char* format, const std::string& name) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.path() / name;
  Assimp::Exporter exporter;
  EXPECT_EQ(exporter.Export(two_tetrahedra().get(), format, file.string()), aiReturn_SUCCESS);
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(Assimp, FilesCutOffOrChangedAnywhereAreScenesOrErrors) {
  const std::string mesh = chunk_3ds(0x4110, counted_3ds<float>(3, {0, 0, 0, 1, 0, 0, 0, 2, 3})) +
                           chunk_3ds(0x4120, counted_3ds<std::uint16_t>(1, {0, 1, 2, 7}));
  const std::string three_ds =
      chunk_3ds(0x4D4D, chunk_3ds(0x3D3D, chunk_3ds(0x4000, std::string("wall\0", 5) + chunk_3ds(0x4100, mesh))));
  const std::vector<std::pair<std::string, std::string>> files = {
      {"a.ply", exported("ply", "a.ply")},
      {"b.ply", exported("plyb", "b.ply")},
      {"a.stl", exported("stl", "a.stl")},
      {"b.stl", exported("stlb", "b.stl")},
      {"a.dae", exported("collada", "a.dae")},
      {"a.fbx", FbxBinary(fbx_tetrahedron(false, 100.0)).bytes()},
      {"b.fbx", fbx_text(fbx_tetrahedron(false, 100.0))},
      {"a.3ds", three_ds},
      {"a.ifc", ifc_box}};
  constexpr std::size_t points = 16;
  for (const auto& [name, whole] : files) {
    for (std::size_t i = 0; i < points; ++i) {
      const std::size_t at = whole.size() * i / points;
      expect_scene_or_one_line(whole.substr(0, at), name, name + " cut at " + std::to_string(at));
      for (const char wrong : {'\0', '\xff', '9'}) {
        std::string changed = whole;
        changed[at] = wrong;
        expect_scene_or_one_line(changed, name, name + " changed at " + std::to_string(at));
      }
    }
  }
}

TEST(Assimp, NumbersThatAreNoneAreInputErrors) {
  const auto ply = [](const std::string& number) {
    return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 " +
           number + "\n0 1 0\n3 0 1 2\n";
  };
  EXPECT_EQ(load_error(ply("0"), "a.ply"), "no error");
  EXPECT_NE(load_error(ply("inf"), "a.ply"), "no error");
  EXPECT_NE(load_error(ply("1e30"), "a.ply"), "no error");
}

TEST(Assimp, PlyHeadersWithoutEndAreRefused) {
  EXPECT_EQ(load_error("ply\nformat ascii 1.0\nelement vertex 3\n", "a.ply"), ": the header of the PLY has no end");
}

TEST(ChildProcess, WhateverHappensEndsAsBytesOrAnError) {
  const ScratchFolder folder;
  const std::filesystem::path file = folder.write("x", "x");
  const auto error_of = [&](const std::function<void(ByteSink&)>& work) -> std::string {
    try {
      run_in_child(file, work);
    } catch (const InputError& error) {
      return error.reason();
    }
    return "no error";
  };
  const std::string large(300000, 'a');
  EXPECT_EQ(run_in_child(file, [&](ByteSink& sink) { sink.write(large.data(), large.size()); }).size(), large.size());
  EXPECT_EQ(error_of([](ByteSink&) { throw std::runtime_error("two\nlines"); }), "two lines");
  EXPECT_EQ(error_of([](ByteSink&) { throw std::bad_alloc(); }), "needs more memory than there is");
  EXPECT_EQ(error_of([](ByteSink&) { std::abort(); }), "is broken in a way that its reader does not survive");
  EXPECT_EQ(error_of([](ByteSink&) { raise(SIGSEGV); }), "is broken in a way that its reader does not survive");
  EXPECT_EQ(error_of([](ByteSink&) { raise(SIGXCPU); }), "takes too long to read");
}

TEST(Assimp, TextsThatEndEarlyAreSeen) {
  const std::string ply = exported("ply", "a.ply"), stl = exported("stl", "a.stl");
  EXPECT_EQ(load_error(ply, "a.ply"), "no error");
  // Cut off within the faces, then within the vertices: assimp makes up the rest.
  const std::size_t last_line = ply.rfind('\n', ply.size() - 2) + 1, body = ply.find("end_header\n") + 11;
  EXPECT_EQ(load_error(ply.substr(0, last_line), "a.ply"), ": element face: has 7 lines, not 8");
  EXPECT_EQ(load_error(ply.substr(0, body), "a.ply"), ": element vertex: has 0 lines, not 8");
  const auto warnings = [](const std::string& bytes) { return load_bytes(bytes, "a.stl").warnings; };
  EXPECT_TRUE(warnings(stl).empty());
  EXPECT_EQ(warnings(stl.substr(0, stl.find("endfacet") + 9)),
            std::vector<std::string>{"has no endsolid: the file may be cut off"});
}

TEST(Assimp, IndicesBeyondTheVerticesAreInputErrors) {
  const auto ply = [](const std::string& corner) {
    return "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 " +
           corner + "\n";
  };
  EXPECT_EQ(load_error(ply("2"), "a.ply"), "no error");
  EXPECT_EQ(load_error(ply("77"), "a.ply"), ": mesh 0: face 0: vertex 77 is beyond the 3 there are");
}

TEST(Assimp, BrokenFilesAreInputErrors) {
  for (const char* name : {"a.ply", "a.stl", "a.dae", "a.fbx", "a.3ds", "a.ifc"}) {
    EXPECT_EQ(load_error("", name), ": is empty") << name;
    EXPECT_NE(load_error("this is no scene at all", name), "no error") << name;
    EXPECT_NE(load_error(std::string(2000, '\xff'), name), "no error") << name;
    EXPECT_THROW(load_scene(std::string("/no such folder/") + name), InputError);
  }
}

}  // namespace
}  // namespace sightline::test
