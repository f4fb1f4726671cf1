// Automatic occluders and what they are made of: patches are equal to their triangles as point sets, boxes lie inside,
// and an occluder never covers a sample that its mesh does not cover at the same depth or nearer.
#include "sightline/raster/auto_occluders.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "agreement/cases.hpp"
#include "sightline/oracle/oracle.hpp"
#include "sightline/raster/coplanar_patches.hpp"
#include "sightline/raster/solid_boxes.hpp"
#include "sightline/scene/topology.hpp"

namespace sightline {
namespace {

std::vector<Patch> patches_of(const Mesh& mesh) { return coplanar_patches(mesh.positions, mesh.triangles); }

std::size_t count(const std::vector<Patch>& patches) {
  return std::accumulate(patches.begin(), patches.end(), std::size_t{0},
                         [](std::size_t sum, const Patch& p) { return sum + p.triangles.size(); });
}

double area(const Mesh& mesh, const std::vector<glm::uvec3>& triangles) {
  double sum = 0;
  for (const glm::uvec3& t : triangles) {
    const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    sum += 0.5 * glm::length(glm::cross(b - a, c - a));
  }
  return sum;
}

/// A flat grid in the plane of two directions, with cells left out where `hole` says so.
template <class F>
Mesh grid(std::uint32_t n, const glm::vec3& u, const glm::vec3& v, F&& hole) {
  Mesh mesh;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i)
      mesh.positions.push_back(static_cast<float>(i) * u + static_cast<float>(j) * v);
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      if (hole(i, j)) continue;
      const std::uint32_t a = j * (n + 1) + i;
      mesh.triangles.push_back({a, a + 1, a + n + 2});
      mesh.triangles.push_back({a, a + n + 2, a + n + 1});
    }
  return mesh;
}

TEST(CoplanarPatches, AFineWallBecomesTwoTriangles) {
  for (const glm::vec3& v : {glm::vec3(0, 0.3f, 0), glm::vec3(0, 0.25f, 0.5f)}) {
    const Mesh mesh = grid(20, {0.3f * (v.z == 0 ? 1.0f : 0.0f) + (v.z == 0 ? 0.0f : 0.5f), 0, 0}, v,
                           [](auto, auto) { return false; });
    const auto patches = patches_of(mesh);
    ASSERT_EQ(patches.size(), 1u);
    EXPECT_EQ(patches[0].triangles.size(), 2u);
    EXPECT_EQ(patches[0].original, 800u);
    EXPECT_NEAR(area(mesh, patches[0].triangles), area(mesh, mesh.triangles), 1e-6);
  }
}

TEST(CoplanarPatches, HolesStayOpen) {
  const Mesh mesh = grid(12, {1, 0, 0}, {0, 1, 0}, [](auto i, auto j) { return i % 4 == 1 && j % 4 == 2; });
  const auto patches = patches_of(mesh);
  ASSERT_EQ(patches.size(), 1u);
  EXPECT_LT(patches[0].triangles.size(), 100u);
  EXPECT_NEAR(area(mesh, patches[0].triangles), area(mesh, mesh.triangles), 1e-6);
}

// Corners that a neighbour keeps are kept by both: no seam opens where two patches meet.
TEST(CoplanarPatches, NeighboursShareTheirCorners) {
  Mesh box = cases::cube();
  auto patches = patches_of(box);
  EXPECT_EQ(patches.size(), 6u);
  EXPECT_EQ(count(patches), 12u);
  Mesh bent = grid(8, {1, 0, 0}, {0, 1, 0}, [](auto, auto) { return false; });
  for (std::size_t i = 0; i < bent.positions.size(); ++i)
    if (bent.positions[i].x > 4) bent.positions[i].z = bent.positions[i].x - 4;
  patches = patches_of(bent);
  ASSERT_EQ(patches.size(), 2u);
  EXPECT_EQ(count(patches), 4u);
  const Topology joined = [&] {
    std::vector<glm::uvec3> all;
    for (const Patch& p : patches) all.insert(all.end(), p.triangles.begin(), p.triangles.end());
    return build_topology(bent.positions, all);
  }();
  EXPECT_EQ(std::count_if(joined.edges.begin(), joined.edges.end(), [](const MeshEdge& e) { return e.count == 2; }), 3);
}

TEST(CoplanarPatches, NearlyFlatIsNotFlatAndFoldedIsNotMerged) {
  Mesh sheet = cases::sheet(6, 1e-6f, false);
  EXPECT_EQ(count(patches_of(sheet)), sheet.triangles.size());
  Mesh folded{"folded", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2f, 0.9f, 0}}, {{0, 1, 2}, {1, 0, 3}}, false, {}};
  EXPECT_EQ(patches_of(folded).size(), 2u);
  Mesh broken = cases::cube();
  broken.triangles.push_back({0, 0, 1});
  broken.triangles.push_back({0, 2, 1});
  EXPECT_LE(count(patches_of(broken)), 13u);
  EXPECT_TRUE(patches_of({"empty", {}, {}, false, {}}).empty());
}

Mesh ball(std::uint32_t n, float radius) {
  Mesh mesh;
  constexpr double pi = 3.14159265358979323846;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i < 2 * n; ++i) {
      const double a = pi * j / n, b = pi * i / n;
      const bool pole = j == 0 || j == n;
      mesh.positions.emplace_back(pole ? 0.0f : radius * static_cast<float>(std::sin(a) * std::cos(b)),
                                  radius * static_cast<float>(std::cos(a)),
                                  pole ? 0.0f : radius * static_cast<float>(std::sin(a) * std::sin(b)));
    }
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < 2 * n; ++i) {
      const std::uint32_t a = j * 2 * n + i, b = j * 2 * n + (i + 1) % (2 * n);
      if (j > 0) mesh.triangles.push_back({a, b, a + 2 * n});
      if (j + 1 < n) mesh.triangles.push_back({b, b + 2 * n, a + 2 * n});
    }
  return mesh;
}

Mesh built(Mesh mesh) {
  SceneBuilder builder;
  builder.add_object(builder.add_mesh(std::move(mesh)), identity_affine());
  return builder.build().meshes()[0];
}

TEST(SolidBoxes, LieInsideABall) {
  const Mesh mesh = built(ball(24, 2));
  ASSERT_TRUE(mesh.closed);
  EXPECT_EQ(std::abs(winding_number(mesh, {0, 0, 0})), 1);
  EXPECT_EQ(winding_number(mesh, {0, 2.1, 0}), 0);
  const auto boxes = solid_boxes(mesh);
  ASSERT_FALSE(boxes.empty());
  for (const Aabb& box : boxes)
    for (int i = 0; i < 8; ++i) EXPECT_LT(glm::length(box.corner(i)), 2.0f);
  EXPECT_GT(boxes[0].half_area(), 3 * 1.8f * 1.8f) << "the largest cube inside has an edge of 2.3";
}

TEST(SolidBoxes, AHollowIsNotSolidAndOpenMeshesHaveNone) {
  Mesh shell = cases::cube(2);
  const Mesh inner = cases::cube(1.5f);
  for (const glm::vec3& p : inner.positions) shell.positions.push_back(p);
  for (const glm::uvec3& t : inner.triangles) shell.triangles.push_back(glm::uvec3(t.y, t.x, t.z) + 8u);
  const Mesh mesh = built(shell);
  ASSERT_TRUE(mesh.closed);
  const Aabb cavity{glm::vec3(-1.5f), glm::vec3(1.5f)};
  for (const Aabb& box : solid_boxes(mesh, {.cells = 40, .boxes = 8, .gain = 0.01}))
    EXPECT_FALSE(box.overlaps(cavity)) << box.lo.x << " " << box.hi.x;
  Mesh open = cases::cube(2);
  open.triangles.pop_back();
  EXPECT_TRUE(solid_boxes(built(open)).empty());
  EXPECT_TRUE(solid_boxes(built(cases::quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}))).empty());
  EXPECT_TRUE(solid_boxes({"empty", {}, {}, false, {}}).empty());
}

/// What an occluder covers must be covered by the original at the same depth or nearer.
void expect_covered(const std::string& name, const Scene& original, const Scene& occluders, const View& view) {
  Frame real, drawn;
  Oracle(original).draw(view, real);
  Oracle(occluders).draw(view, drawn);
  const double slack = 2 * depth_error * (reach(original.bounds()) + glm::length(view.eye));
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < drawn.depth.size(); ++i)
    if (std::isfinite(drawn.depth[i]) &&
        !(real.depth[i] <= drawn.depth[i] + slack + 2 * depth_error * std::abs(static_cast<double>(drawn.depth[i]))))
      ++wrong;
  // A ray may slip by a few pixels along the common border of two triangles that another triangulation does not have.
  EXPECT_EQ(wrong, 0u) << name << " from " << describe(view);
}

bool wholly_behind_near(const Aabb& box, const View& view) {
  for (int i = 0; i < 8; ++i)
    if (glm::dot(view_direction(view), glm::dvec3(box.corner(i)) - view.eye) <= 1.001 * view.near) return false;
  return true;
}

void expect_inside(const std::string& name, const Scene& scene, std::size_t most_meshes) {
  const AutoOccluders occluders =
      make_auto_occluders(scene, {.budget = 1'000'000, .share = 1, .solids = true, .cells = 16});
  std::size_t tried = 0;
  for (MeshId m = 0; m < scene.meshes().size() && tried < most_meshes; ++m) {
    const AutoOccluder& occluder = occluders.meshes[m];
    for (const bool solid : {false, true}) {
      const Mesh& part = solid ? occluder.solid : occluder.surface;
      if (part.triangles.empty()) continue;
      ++tried;
      SceneBuilder one, two;
      one.add_object(one.add_mesh(scene.meshes()[m]), identity_affine());
      two.add_object(two.add_mesh(part), identity_affine());
      const Scene original = one.build(), drawn = two.build();
      for (const View& view : cases::hard_views(original, 9, m + 3, 96))
        if (!solid || wholly_behind_near(original.bounds(), view))
          expect_covered(name + (solid ? " solid " : " surface ") + std::to_string(m), original, drawn, view);
    }
  }
}

TEST(AutoOccluders, CoverNothingThatTheirMeshDoesNotCover) {
  for (const cases::Case& c : cases::generated()) expect_inside(c.name, c.scene, 12);
  SceneBuilder builder;
  for (const Mesh& mesh : {ball(24, 2), cases::sheet(12, 0.2f, true),
                           grid(9, {1, 0, 0}, {0, 1, 0}, [](auto i, auto j) { return i % 3 == 1 && j % 3 == 1; })})
    builder.add_object(builder.add_mesh(mesh), identity_affine());
  expect_inside("shapes", builder.build(), 10);
}

TEST(AutoOccluders, OfTheWholeSceneCoverNothingThatTheSceneDoesNotCover) {
  for (const char* kind : {"building", "city"}) {
    const Scene scene = generate_scene(kind, {.objects = 150, .triangles = 0, .seed = 4});
    SceneBuilder builder;
    builder.add_object(
        builder.add_mesh(make_scene_occluder(scene, {.budget = 2000, .share = 1, .solids = false, .cells = 16})),
        identity_affine());
    const Scene drawn = builder.build();
    for (const View& view : cases::hard_views(scene, 12, 5)) expect_covered(kind, scene, drawn, view);
  }
}

TEST(AutoOccluders, KeepTheBudgetAndLeaveGlassAlone) {
  const Scene scene = generate_scene("city", {.objects = 300, .triangles = 0, .seed = 2});
  for (const std::uint64_t budget : {1u, 100u, 1000u, 5000u}) {
    const AutoOccluders occluders =
        make_auto_occluders(scene, {.budget = budget, .share = 0, .solids = true, .cells = 12});
    EXPECT_LE(occluders.triangles, budget);
    std::uint64_t drawn = 0;
    for (const Object& object : scene.objects())
      if (object.opaque)
        drawn += occluders.meshes[object.mesh].surface.triangles.size() +
                 occluders.meshes[object.mesh].solid.triangles.size();
    EXPECT_EQ(drawn, occluders.triangles);
    EXPECT_EQ(occluders.surface_triangles + occluders.solid_triangles, occluders.triangles);
  }
  SceneBuilder builder;
  builder.add_object(builder.add_mesh(cases::cube()), identity_affine(), "glass", {}, false);
  EXPECT_EQ(make_auto_occluders(builder.build(), {.budget = 100, .share = 1, .solids = true, .cells = 8}).triangles,
            0u);
  EXPECT_EQ(make_auto_occluders(SceneBuilder().build()).triangles, 0u);
}

}  // namespace
}  // namespace sightline
