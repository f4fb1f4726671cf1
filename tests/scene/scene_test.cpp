// The scene builder: what it refuses, and bounds that hold everything and little more.
#include "sightline/scene/scene.hpp"

#include <gtest/gtest.h>
#include <malloc.h>

#include <cstdio>
#include <string>

#include <functional>
#include <limits>

#include "properties.hpp"
#include "scene/shapes.hpp"
#include "sightline/scene/input_error.hpp"

namespace sightline {
namespace {

Affine moved(float x, float y, float z) {
  Affine m = identity_affine();
  m[3] = {x, y, z};
  return m;
}

TEST(Scene, EmptySceneIsFine) {
  const Scene scene = SceneBuilder().build();
  EXPECT_TRUE(scene.objects().empty());
  EXPECT_TRUE(scene.bounds().empty());
  EXPECT_EQ(scene.triangle_count(), 0u);
  EXPECT_TRUE(scene.object_bounds().empty());
}

TEST(Scene, KeepsWhatItWasGiven) {
  SceneBuilder builder;
  const MeshId cube = builder.add_mesh(shapes::cube());
  Mesh open = shapes::cube();
  open.triangles.pop_back();
  const MeshId lid = builder.add_mesh(open);
  const ObjectId first = builder.add_object(cube, moved(5, 0, 0), "Haus", {3, 1});
  const ObjectId second = builder.add_object(lid, moved(0, 0, -5), "", {}, false);
  const ObjectId third = builder.add_object(cube, identity_affine(), "third");
  EXPECT_EQ(builder.object_count(), 3u);
  EXPECT_EQ(builder.mesh_count(), 2u);
  const Scene scene = builder.build();
  ASSERT_EQ(scene.objects().size(), 3u);
  EXPECT_EQ(scene.name(first), "Haus");
  EXPECT_EQ(scene.name(second), "");
  EXPECT_EQ(scene.name(third), "third");
  EXPECT_EQ(scene.source(first).node, 3);
  EXPECT_EQ(scene.source(first).primitive, 1);
  EXPECT_EQ(scene.source(second).node, -1);
  EXPECT_TRUE(scene.objects()[first].opaque);
  EXPECT_FALSE(scene.objects()[second].opaque);
  EXPECT_TRUE(scene.mesh_of(first).closed);
  EXPECT_FALSE(scene.mesh_of(second).closed);
  EXPECT_EQ(scene.triangle_count(), 12u + 11u + 12u);
  EXPECT_EQ(scene.mesh_of(first).bounds, (Aabb{{0, 0, 0}, {1, 1, 1}}));
  EXPECT_TRUE(scene.bounds().contains(Aabb{{0, 0, -5}, {6, 1, 1}}));
  EXPECT_EQ(builder.object_count(), 0u) << "build() empties the builder";
}

TEST(Scene, CellsAndPortalsAreKept) {
  SceneBuilder builder;
  const MeshId cube = builder.add_mesh(shapes::cube());
  const ObjectId id = builder.add_object(cube, identity_affine());
  const std::uint32_t a = builder.add_cell({"hall", {{0, 0, 0}, {1, 1, 1}}, {id}});
  const std::uint32_t b = builder.add_cell({"yard", {{1, 0, 0}, {2, 1, 1}}, {}});
  builder.add_portal({{a, b}, {{1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 0, 1}}});
  const Scene scene = builder.build();
  ASSERT_EQ(scene.cells().size(), 2u);
  EXPECT_EQ(scene.cells()[a].objects, std::vector<ObjectId>{id});
  ASSERT_EQ(scene.portals().size(), 1u);
  EXPECT_EQ(scene.portals()[0].polygon.size(), 4u);
}

TEST(Scene, UnusedVerticesDoNotWidenBounds) {
  Mesh mesh = shapes::cube();
  mesh.positions.insert(mesh.positions.begin(), glm::vec3(1e6f));
  for (glm::uvec3& t : mesh.triangles) t += 1u;
  mesh.positions.push_back(glm::vec3(-1e6f));
  SceneBuilder builder;
  builder.add_object(builder.add_mesh(mesh), identity_affine());
  const Scene scene = builder.build();
  EXPECT_EQ(scene.mesh_of(0).bounds, (Aabb{{0, 0, 0}, {1, 1, 1}}));
  EXPECT_TRUE(scene.mesh_of(0).closed);
  EXPECT_LT(reach(scene.bounds()), 1.001f);
}

TEST(Scene, MeshWithoutTrianglesHasEmptyBounds) {
  SceneBuilder builder;
  Mesh dust;
  dust.positions = {{1, 2, 3}};
  builder.add_object(builder.add_mesh(dust), identity_affine());
  const Scene scene = builder.build();
  EXPECT_TRUE(scene.objects()[0].bounds.empty());
  EXPECT_TRUE(scene.bounds().empty());
}

TEST(Scene, MovedObjectsTakeTheirBoundsAlong) {
  SceneBuilder builder;
  Mesh triangle;
  triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  triangle.triangles = {{0, 1, 2}};
  const MeshId mesh = builder.add_mesh(triangle);
  for (int i = 0; i < 2; ++i) builder.add_object(mesh, identity_affine());
  Scene scene = builder.build();
  const auto at = [](float x) { return Affine{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {x, 0, 0}}; };
  scene.move_objects(std::vector<Scene::Move>{{1, at(10)}});
  EXPECT_EQ(scene.objects()[1].transform[3].x, 10.0f);
  EXPECT_TRUE(scene.objects()[1].bounds.contains({{10, 0, 0}, {11, 1, 0}}));
  EXPECT_NEAR(scene.bounds().hi.x, 11.0f, 1e-4f);
  scene.move_objects(std::vector<Scene::Move>{{1, at(0)}});
  EXPECT_NEAR(scene.bounds().hi.x, 1.0f, 1e-4f) << "the scene shrinks again";
  // Nothing moves when one of several cannot.
  for (const Scene::Move& bad : {Scene::Move{2, at(1)}, Scene::Move{1, at(std::numeric_limits<float>::quiet_NaN())},
                                 Scene::Move{1, at(1e16f)}}) {
    EXPECT_THROW(scene.move_objects(std::vector<Scene::Move>{{0, at(5)}, bad}), InputError);
    EXPECT_EQ(scene.objects()[0].transform[3].x, 0.0f);
  }
}

TEST(Scene, BuilderNamesWhatIsWrong) {
  struct Case {
    const char* what;
    std::function<void(SceneBuilder&)> spoil;
  };
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const auto with_vertex = [](float x) {
    Mesh mesh = shapes::cube();
    mesh.name = "bad one";
    mesh.positions[4].y = x;
    return mesh;
  };
  const std::vector<Case> cases{
      {"bad one", [&](SceneBuilder& b) { b.add_mesh(with_vertex(nan)); }},
      {"bad one", [&](SceneBuilder& b) { b.add_mesh(with_vertex(-inf)); }},
      {"beyond the last of 8",
       [&](SceneBuilder& b) {
         Mesh mesh = shapes::cube();
         mesh.triangles[7].z = 8;
         b.add_mesh(mesh);
       }},
      {"object 1", [&](SceneBuilder& b) { b.add_object(77, identity_affine()); }},
      {"object 1", [&](SceneBuilder& b) { b.add_object(0, moved(0, nan, 0)); }},
      {"object 1", [&](SceneBuilder& b) { b.add_object(0, moved(inf, 0, 0)); }},
      {"object 1",
       [&](SceneBuilder& b) {
         Affine overflow(3e38f);  // finite, but the vertices that it makes are not
         overflow[3] = glm::vec3(3e38f);
         b.add_object(0, overflow);
       }},
      {"cell attic", [&](SceneBuilder& b) { b.add_cell({"attic", {}, {5}}); }},
      {"portal", [&](SceneBuilder& b) { b.add_portal({{0, 1}, {}}); }},
  };
  for (const Case& c : cases) {
    SceneBuilder builder;
    builder.add_object(builder.add_mesh(shapes::cube()), identity_affine());
    c.spoil(builder);
    try {
      builder.build();
      ADD_FAILURE() << "accepted what should fail with " << c.what;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(c.what), std::string::npos) << error.what();
    }
  }
}

/// Any affine map: rotations, mirrors, shears, flat ones.
Affine random_affine(double reach) {
  Affine m;
  for (int c = 0; c < 3; ++c) m[c] = glm::vec3(properties::point(*rc::gen::element(0.0, 1e-3, 1.0, 50.0)));
  m[3] = glm::vec3(properties::point(reach));
  return m;
}

RC_GTEST_PROP(SceneProperty, BoundsHoldEveryVertexAndLittleMore, ()) {
  Mesh mesh;
  const double size = *rc::gen::element(1e-3, 1.0, 1e4);
  for (int i = 0; i < 12; ++i) mesh.positions.push_back(glm::vec3(properties::point(size)));
  for (std::uint32_t i = 0; i < 12; i += 3) mesh.triangles.push_back({i, i + 1, i + 2});
  const Affine m = random_affine(*rc::gen::element(0.0, 10.0, 1e6));
  SceneBuilder builder;
  builder.add_object(builder.add_mesh(mesh), m);
  const Scene scene = builder.build();
  const Aabb& box = scene.objects()[0].bounds;
  const glm::dmat4 exact = to_matrix(m);
  glm::dvec3 lo(1e300), hi(-1e300);
  for (const glm::vec3& p : mesh.positions) {
    const glm::dvec3 q(exact * glm::dvec4(p, 1.0));
    lo = glm::min(lo, q);
    hi = glm::max(hi, q);
  }
  const glm::dvec3 reach_of_terms = glm::abs(glm::dvec3(m[0])) * size + glm::abs(glm::dvec3(m[1])) * size +
                                    glm::abs(glm::dvec3(m[2])) * size + glm::abs(glm::dvec3(m[3]));
  for (int axis = 0; axis < 3; ++axis) {
    RC_ASSERT(box.lo[axis] <= lo[axis]);
    RC_ASSERT(box.hi[axis] >= hi[axis]);
    RC_ASSERT(lo[axis] - box.lo[axis] <= 1e-6 * reach_of_terms[axis]);
    RC_ASSERT(box.hi[axis] - hi[axis] <= 1e-6 * reach_of_terms[axis]);
  }
}

TEST(Scene, RefusesWhatLiesBeyondAllReach) {
  for (const float far : {1e16f, 1e30f}) {
    SceneBuilder builder;
    builder.add_object(builder.add_mesh(shapes::cube()), moved(far, 0, 0));
    EXPECT_THROW(builder.build(), InputError) << far;
  }
  SceneBuilder builder;
  builder.add_object(builder.add_mesh(shapes::cube()), moved(1e14f, 0, 0));
  EXPECT_NO_THROW(builder.build());
}

/// Of the objects, their names and sources, beside the shared meshes; what the heap says, not what we count.
TEST(SceneMemory, AMillionObjectsTakeAtMost200BytesEach) {
  constexpr std::uint32_t count = 1'100'000;  // just above a power of two, where growing arrays are half empty
  const auto allocated = [] {
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
  };
  const std::size_t before = allocated();
  SceneBuilder builder;
  const MeshId mesh = builder.add_mesh(shapes::cube());
  for (std::uint32_t i = 0; i < count; ++i)
    builder.add_object(mesh, identity_affine(), "object " + std::to_string(i), {static_cast<std::int32_t>(i), 0});
  const Scene scene = builder.build();
  const std::size_t after = allocated();
  if (after == before) GTEST_SKIP() << "SKIPPED: this heap does not say what is allocated";
  const double bytes = static_cast<double>(after - before) / count;
  EXPECT_LE(bytes, 200.0);
  EXPECT_GE(bytes, sizeof(Object)) << "the measurement does not measure";
  RecordProperty("bytes_per_object", std::to_string(bytes));
  std::printf("%.1f bytes for each object\n", bytes);
}

}  // namespace
}  // namespace sightline
