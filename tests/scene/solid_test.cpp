// Which meshes may lose their back faces: closed, oriented, turned outwards.
#include "sightline/scene/solid.hpp"

#include <gtest/gtest.h>

#include "scene/shapes.hpp"
#include "sightline/scene/generate/shapes.hpp"
#include "sightline/scene/mesh_eye.hpp"

namespace sightline {
namespace {

Solidity of(Mesh mesh) {
  SceneBuilder builder;
  builder.add_object(builder.add_mesh(std::move(mesh)), identity_affine());
  const Scene scene = builder.build();
  return solidity_of(scene.meshes()[0]);
}

void turn(Mesh& mesh) {
  for (glm::uvec3& t : mesh.triangles) std::swap(t.x, t.y);
}

TEST(Solid, ClosedAndOutwards) {
  EXPECT_EQ(of(shapes::cube()), Solidity::solid);
  EXPECT_EQ(of(shapes::split_vertices(shapes::cube())), Solidity::solid);
  EXPECT_EQ(of(make_ball(12, 8)), Solidity::solid);
  EXPECT_EQ(of(shapes::moebius_strip(12)), Solidity::open);
  Mesh open = shapes::cube();
  open.triangles.pop_back();
  EXPECT_EQ(of(open), Solidity::open);
  Mesh mixed = shapes::cube();
  std::swap(mixed.triangles[3].x, mixed.triangles[3].y);
  EXPECT_EQ(of(mixed), Solidity::open);
  EXPECT_EQ(of({"empty", {}, {}, false, {}}), Solidity::open);
}

TEST(Solid, InsideOut) {
  Mesh room = shapes::cube();
  turn(room);
  EXPECT_EQ(of(room), Solidity::inverted);
  Mesh both = make_box({5, 0, 0}, {6, 1, 1});  // one part outwards, a larger one inwards
  append(both, room, Affine{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}});
  EXPECT_EQ(of(both), Solidity::inverted);
  // Far from the origin the sign is that of the part, not of the place.
  Mesh far = make_box({1000, 1000, 1000}, {1000.01f, 1000.01f, 1000.01f});
  EXPECT_EQ(of(far), Solidity::solid);
  // Two coincident sheets back to back enclose nothing: from either side a front face is seen.
  Mesh sheets{"sheets", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}, false, {}};
  EXPECT_EQ(of(sheets), Solidity::solid);
}

/// The eye in mesh space: mirrors turn nothing round, the identity needs no slack for rounded corners.
TEST(MeshEye, EyeAndSlack) {
  SceneBuilder builder;
  const MeshId mesh = builder.add_mesh(make_box({-1, -1, -1}, {1, 1, 1}));
  builder.add_object(mesh, identity_affine());
  builder.add_object(mesh, {{-2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {10, 0, 0}});
  builder.add_object(mesh, {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}});
  const Scene scene = builder.build();
  const View view = look_along({16, 0, 0}, {-1, 0, 0});
  const auto eye = [&](ObjectId id) { return mesh_eye(view, scene.objects()[id], scene.mesh_of(id)); };
  EXPECT_EQ(eye(0).eye, glm::vec4(16, 0, 0, 1));
  EXPECT_EQ(eye(0).sharpness, 0.0f);
  EXPECT_EQ(eye(1).eye, glm::vec4(-3, 0, 0, 1));  // beyond the side that is mirrored to it
  EXPECT_GT(eye(1).sharpness, 0.0f);
  EXPECT_FALSE(eye(2).valid);
  View flat = view;
  flat.projection = Projection::orthographic;
  EXPECT_LT(glm::distance(mesh_eye(flat, scene.objects()[1], scene.mesh_of(1)).eye, glm::vec4(-1, 0, 0, 0)), 1e-6f);
}

}  // namespace
}  // namespace sightline
