// Free space: no surface without its cells, floors at their height, solids known from the inside, ways that exist.
#include "sightline/scene/path/free_space.hpp"

#include <gtest/gtest.h>

#include "properties.hpp"
#include "scene/shapes.hpp"
#include "sightline/scene/generate/generate.hpp"
#include "sightline/scene/path/smooth_way.hpp"
#include "sightline/scene/path/walk_graph.hpp"

namespace sightline {
namespace {

FreeSpaceConfig config_of(double cell, double margin) {
  FreeSpaceConfig config;
  config.finest = cell;
  config.margin_side = config.margin_top = margin;
  return config;
}

RC_GTEST_PROP(FreeSpaceProperty, NoPointOfASurfaceIsInAFreeCell, ()) {
  const auto objects = static_cast<std::uint32_t>(*rc::gen::inRange(1, 40));
  const Scene scene = generate_scene("soup", {objects, 0, static_cast<std::uint64_t>(*rc::gen::inRange(1, 1000))});
  const FreeSpace space(scene, config_of(properties::number(0.05, 2), properties::number(0.1, 3)));
  Random random(7);
  for (const Object& object : scene.objects()) {
    const Mesh& mesh = scene.meshes()[object.mesh];
    for (const glm::uvec3& t : mesh.triangles)
      for (int k = 0; k < 8; ++k) {
        const double a = random.uniform(), b = random.uniform() * (1 - a);
        const glm::dvec3 p(transform_point(object.transform, mesh.positions[t.x])),
            q(transform_point(object.transform, mesh.positions[t.y])),
            r(transform_point(object.transform, mesh.positions[t.z]));
        const glm::dvec3 point = p + (q - p) * a + (r - p) * b;
        // Points within rounding of a cell's face may count for either side.
        const glm::dvec3 place = (point - space.origin()) / space.cell();
        if (glm::any(glm::lessThan(glm::abs(place - glm::round(place)), glm::dvec3(1e-4)))) continue;
        RC_ASSERT(!space.free(point));
      }
  }
}

TEST(FreeSpace, EmptySpaceIsFreeAndFloorsAreHigh) {
  SceneBuilder builder;
  builder.add_object(builder.add_mesh(shapes::cube()), identity_affine());
  const Scene scene = builder.build();
  const FreeSpace space(scene, config_of(0.07, 1.0));
  const Aabb box = scene.bounds();
  EXPECT_TRUE(space.free(glm::dvec3(box.centre())));
  EXPECT_TRUE(space.free(glm::dvec3(box.hi) + 0.5));
  EXPECT_FALSE(space.free(glm::dvec3(box.hi) + 50.0)) << "outside of the grid nothing is known";
  const glm::dvec3 top(box.centre().x + 0.03, box.hi.y, box.centre().z + 0.03);
  EXPECT_NEAR(space.floor(space.cell_of(top - glm::dvec3(0, 1e-4, 0))), box.hi.y, 1e-5);
  const glm::dvec3 bottom(top.x, box.lo.y + 1e-4, top.z);
  EXPECT_LT(space.floor(space.cell_of(bottom)), -1e30f) << "the lower face looks down";
}

RC_GTEST_PROP(InsideClosedObject, PropertyAgreesWithABox, ()) {
  SceneBuilder builder;
  const Affine transform(glm::vec3(2, 0, 0), glm::vec3(0, 3, 0), glm::vec3(0, 0, -1), glm::vec3(5, 1, 2));
  builder.add_object(builder.add_mesh(shapes::cube()), transform);
  const Scene scene = builder.build();
  const Aabb box = scene.bounds();
  // Points on the grid lines of the faces' diagonals come too.
  const glm::dvec3 p = glm::dvec3(box.centre()) +
                       glm::dvec3(*rc::gen::inRange(-9, 10), *rc::gen::inRange(-9, 10), *rc::gen::inRange(-9, 10)) *
                           glm::dvec3(box.extent()) * 0.0763;
  const glm::dvec3 from_centre = glm::abs(p - glm::dvec3(box.centre())) / (0.5 * glm::dvec3(box.extent()));
  const bool inside = glm::all(glm::lessThan(from_centre, glm::dvec3(1)));
  RC_ASSERT(inside_closed_object(scene, p) == inside);
}

TEST(WalkGraph, WaysLeadThroughDoorsNotWalls) {
  const Scene scene = generate_scene("building", {600, 0, 2});
  FreeSpaceConfig config = config_of(0.25, 2.0);
  const FreeSpace space(scene, config);
  const WalkGraph graph(scene, space, Gait::walk, 1.7);
  ASSERT_GT(graph.size(), 500u);
  const std::vector<std::uint32_t> goals = graph.goals();
  for (std::size_t k = 0; k + 1 < 20; ++k) {
    const std::uint32_t from = goals[k * goals.size() / 20], to = goals[(k * 7 + 5) % 20 * goals.size() / 20];
    const std::vector<glm::dvec3> way = graph.way(from, to);
    EXPECT_EQ(way.front(), graph.position(from));
    EXPECT_EQ(way.back(), graph.position(to));
    for (const bool smooth : {false, true})
      for (const glm::dvec3& point : smooth ? smooth_way(space, way, 60) : way) EXPECT_TRUE(space.free(point));
    for (std::size_t i = 1; i < way.size(); ++i) EXPECT_LT(glm::length(way[i] - way[i - 1]), 0.25 * 2.5);
  }
}

TEST(SmoothWay, CutsCornersAndKeepsEnds) {
  SceneBuilder builder;
  builder.add_object(builder.add_mesh(shapes::cube()), Affine(glm::vec3(0.01f, 0, 0), glm::vec3(0, 0.01f, 0),
                                                              glm::vec3(0, 0, 0.01f), glm::vec3(20, 20, 20)));
  const Scene scene = builder.build();
  const FreeSpace space(scene, config_of(0.5, 20.0));
  const std::vector<glm::dvec3> corner{{10, 30, 10}, {18, 30, 10}, {18, 30, 18}};
  const std::vector<glm::dvec3> smooth = smooth_way(space, corner, 200);
  EXPECT_EQ(smooth.front(), corner.front());
  EXPECT_EQ(smooth.back(), corner.back());
  EXPECT_LT(Trail(smooth).length(), 0.95 * Trail(corner).length());
  EXPECT_GT(Trail(smooth).length(), 8 * std::sqrt(2.0));
}

TEST(Trail, MeasuresAlongTheLine) {
  const Trail trail({{0, 0, 0}, {3, 0, 0}, {3, 0, 0}, {3, 4, 0}});
  EXPECT_EQ(trail.length(), 7);
  EXPECT_EQ(trail.at(-1), glm::dvec3(0, 0, 0));
  EXPECT_EQ(trail.at(2), glm::dvec3(2, 0, 0));
  EXPECT_EQ(trail.at(5), glm::dvec3(3, 2, 0));
  EXPECT_EQ(trail.at(9), glm::dvec3(3, 4, 0));
}

}  // namespace
}  // namespace sightline
