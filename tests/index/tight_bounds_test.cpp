// Tight bounds hold every triangle, keep the sigma rule against the original box, and measure unions exactly.
#include "sightline/index/tight_bounds.hpp"

#include <gtest/gtest.h>

#include <glm/gtc/quaternion.hpp>

#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/generate/shapes.hpp"
#include "sightline/scene/occludee_bounds.hpp"

namespace sightline {
namespace {

TEST(TightBounds, UnionsAreExact) {
  const Aabb unit{glm::vec3(0), glm::vec3(1)};
  EXPECT_DOUBLE_EQ(union_surface(std::vector<Aabb>{unit}), 6.0);
  EXPECT_DOUBLE_EQ(union_surface(std::vector<Aabb>{unit, unit}), 6.0);
  // E49: two boxes that share a face are one; the sum would be 12.
  EXPECT_DOUBLE_EQ(union_surface(std::vector<Aabb>{unit, {{1, 0, 0}, {2, 1, 1}}}), 10.0);
  EXPECT_DOUBLE_EQ(union_surface(std::vector<Aabb>{unit, {{3, 0, 0}, {4, 1, 1}}}), 12.0);
  EXPECT_DOUBLE_EQ(union_surface(std::vector<Aabb>{unit, {{0.25f, 0.25f, 0.25f}, {0.5f, 0.5f, 0.5f}}}), 6.0);
  EXPECT_DOUBLE_EQ(union_volume(std::vector<Aabb>{unit, {{0.5f, 0, 0}, {1.5f, 1, 1}}}), 1.5);
  EXPECT_EQ(union_surface({}), 0.0);
  Random random(1);
  for (int round = 0; round < 20; ++round) {  // on a grid of cells, counted
    std::vector<Aabb> boxes;
    std::vector<char> cells(1000);
    for (int b = 0; b < 6; ++b) {
      glm::ivec3 lo(random.below(9), random.below(9), random.below(9)), hi;
      for (int k = 0; k < 3; ++k)
        hi[k] = lo[k] + 1 + static_cast<int>(random.below(static_cast<std::uint32_t>(10 - lo[k])));
      boxes.push_back({glm::vec3(lo), glm::vec3(hi)});
      for (int x = lo.x; x < hi.x; ++x)
        for (int y = lo.y; y < hi.y; ++y)
          for (int z = lo.z; z < hi.z; ++z) cells[static_cast<std::size_t>(100 * x + 10 * y + z)] = 1;
    }
    int volume = 0, surface = 0;
    const auto at = [&](int x, int y, int z) {
      return x >= 0 && y >= 0 && z >= 0 && x < 10 && y < 10 && z < 10 &&
             cells[static_cast<std::size_t>(100 * x + 10 * y + z)] != 0;
    };
    for (int x = 0; x < 10; ++x)
      for (int y = 0; y < 10; ++y)
        for (int z = 0; z < 10; ++z) {
          if (!at(x, y, z)) continue;
          ++volume;
          surface += !at(x + 1, y, z) + !at(x - 1, y, z) + !at(x, y + 1, z) + !at(x, y - 1, z) + !at(x, y, z + 1) +
                     !at(x, y, z - 1);
        }
    EXPECT_NEAR(union_volume(boxes), volume, 1e-9);
    EXPECT_NEAR(union_surface(boxes), surface, 1e-9);
  }
}

/// A pipe with a bend: two boxes hold it far better than one.
Mesh bend() { return make_pipe(std::vector<glm::vec3>{{0, 0, 0}, {10, 0, 0}, {10, 10, 0}}, 0.5f, 8); }

TEST(TightBounds, HoldTheirTrianglesWithinSigma) {
  Mesh soup = bend();
  Random random(2);
  for (int i = 0; i < 300; ++i) {
    const glm::vec3 p(10.0 * random.direction());
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    for (int k = 0; k < 3; ++k) soup.positions.push_back(p + glm::vec3(0.4 * random.direction()));
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  for (const Mesh& mesh : {bend(), soup, make_ball(20, 12), make_box({0, 0, 0}, {1, 2, 3})})
    for (const double sigma : {1.0, 1.2, 1.4, 2.0, 5.0}) {
      TightBoundsConfig config;
      config.sigma = sigma;
      const TightBounds tight = tight_bounds(mesh.positions, mesh.triangles, config);
      ASSERT_GE(tight.boxes.size(), 1u);
      Aabb whole;
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
          EXPECT_TRUE(tight.boxes[tight.box_of[t]].contains(mesh.positions[mesh.triangles[t][k]]));
          whole.extend(mesh.positions[mesh.triangles[t][k]]);
        }
      EXPECT_LE(union_surface(tight.boxes), sigma * 2.0 * whole.half_area() * 1.00001);  // 24.05
      EXPECT_LE(union_volume(tight.boxes), union_volume(std::vector<Aabb>{whole}) * 1.00001);
    }
}

TEST(TightBounds, FindTheBendAndStopAtDepth) {
  const Mesh mesh = bend();
  const TightBounds tight = tight_bounds(mesh.positions, mesh.triangles, {});
  EXPECT_GE(tight.boxes.size(), 2u);
  EXPECT_LT(union_volume(tight.boxes),
            0.4 * union_volume(std::vector<Aabb>{{{-0.5f, -0.5f, -0.5f}, {10.5f, 10.5f, 0.5f}}}));
  TightBoundsConfig flat;
  flat.depth = 0;
  EXPECT_EQ(tight_bounds(mesh.positions, mesh.triangles, flat).boxes.size(), 1u);
  EXPECT_TRUE(tight_bounds({}, {}, {}).boxes.empty());
  // A solid box has nothing to gain.
  const Mesh box = make_box({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(tight_bounds(box.positions, box.triangles, {}).boxes.size(), 1u);
}

TEST(TightBounds, OccludeeBoundsHoldPlacedObjects) {
  Random random(3);
  SceneBuilder builder;
  const MeshId mesh = builder.add_mesh(bend()), empty = builder.add_mesh({"empty", {}, {}, false, {}});
  for (int i = 0; i < 20; ++i) {
    glm::dmat3 linear = glm::mat3_cast(glm::angleAxis(random.range(0, 6), random.direction()));
    if (i % 2 == 0) linear = linear * glm::dmat3(-1, 0, 0, 0.3, 1, 0, 0, 0, 2);
    builder.add_object(mesh, {linear[0], linear[1], linear[2], 100.0 * random.direction()});
  }
  builder.add_object(empty, identity_affine());
  const Scene scene = builder.build();
  const OccludeeBounds bounds(scene, {.sigma = 1.6});
  EXPECT_GT(bounds.count(), 30u);
  EXPECT_TRUE(bounds.boxes(20).empty());
  for (ObjectId id = 0; id < 20; ++id)
    for (const glm::uvec3& t : scene.mesh_of(id).triangles) {
      glm::vec3 corners[3];
      for (int k = 0; k < 3; ++k)
        corners[k] = transform_point(scene.objects()[id].transform, scene.mesh_of(id).positions[t[k]]);
      EXPECT_TRUE(bounds.any(id, [&](const Aabb& box) {
        return box.contains(corners[0]) && box.contains(corners[1]) && box.contains(corners[2]);
      }));
    }
  const OccludeeBounds one(scene, {.sigma = 1.0});
  EXPECT_EQ(one.count(), 20u);
  EXPECT_EQ(one.boxes(3)[0], scene.objects()[3].bounds);
}

}  // namespace
}  // namespace sightline
