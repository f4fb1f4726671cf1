// Building blocks: closed, outward, of the volume that they should have; refinement keeps shape, closedness and count.
#include "sightline/scene/generate/shapes.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "properties.hpp"
#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/topology.hpp"

namespace sightline {
namespace {

double volume(const Mesh& mesh) { return signed_volume6(mesh) / 6; }
bool closed(const Mesh& mesh) { return is_closed(build_topology(mesh.positions, mesh.triangles)); }

double surface(const Mesh& mesh) {
  double sum = 0;
  for (const glm::uvec3& t : mesh.triangles)
    sum += 0.5 * glm::length(glm::cross(glm::dvec3(mesh.positions[t.y]) - glm::dvec3(mesh.positions[t.x]),
                                        glm::dvec3(mesh.positions[t.z]) - glm::dvec3(mesh.positions[t.x])));
  return sum;
}

// Area of the regular polygon of circumradius 1.
double polygon(int sides) { return 0.5 * sides * std::sin(2 * M_PI / sides); }

TEST(Shapes, VolumesAreExact) {
  const Mesh box = make_box({-1, 2, 3}, {1, 5, 7});
  EXPECT_TRUE(closed(box));
  EXPECT_NEAR(volume(box), 2 * 3 * 4, 1e-9);
  EXPECT_NEAR(surface(box), 2 * (2 * 3 + 3 * 4 + 4 * 2), 1e-9);
  for (const int sides : {3, 4, 7, 24}) {
    EXPECT_TRUE(closed(make_cylinder(sides)));
    EXPECT_NEAR(volume(make_cylinder(sides)), polygon(sides), 1e-6);
    EXPECT_TRUE(closed(make_ball(sides, 2)));
    EXPECT_NEAR(volume(make_ball(sides, 2)), polygon(sides) * 2 / 3, 1e-6) << "two pyramids";
  }
  EXPECT_NEAR(volume(make_ball(200, 100)), 4.0 / 3 * M_PI, 0.005);
  EXPECT_TRUE(closed(make_gable()));
  EXPECT_NEAR(volume(make_gable()), 0.5, 1e-9);
}

TEST(Shapes, LatheWithLedgesAndTip) {
  const glm::vec2 profile[] = {{2, 0}, {2, 1}, {1, 1}, {1, 3}, {0, 6}};
  const Mesh tower = make_lathe(profile, square_section());
  EXPECT_TRUE(closed(tower));
  EXPECT_NEAR(volume(tower), 16 * 1 + 4 * 2 + 4 * 3 / 3.0, 1e-6);
}

TEST(Shapes, WallIsItsFrontTimesThickness) {
  const Opening openings[] = {{1, 0, 2, 2}, {3, 1, 4, 2}, {3, 2.25f, 4, 2.5f}};
  const Mesh wall = make_wall(5, 0, 3, 0.25f, openings);
  EXPECT_TRUE(closed(wall));
  EXPECT_NEAR(volume(wall), 0.25 * (15 - 2 - 1 - 0.25), 1e-6);
  Aabb bounds;
  for (const glm::vec3& p : wall.positions) bounds.extend(p);
  EXPECT_EQ(bounds, (Aabb{{0, 0, -0.125f}, {5, 3, 0.125f}}));
}

TEST(Shapes, PipeKeepsItsWidthRoundBends) {
  const glm::vec3 straight[] = {{0, 0, 0}, {3, 0, 0}};
  EXPECT_TRUE(closed(make_pipe(straight, 0.5f, 12)));
  EXPECT_NEAR(volume(make_pipe(straight, 0.5f, 12)), 3 * 0.25 * polygon(12), 1e-6);
  // By Pappus a mitred pipe has the volume of its centre line times its section.
  const glm::vec3 bent[] = {{0, 0, 0}, {2, 0, 0}, {2, 0, 2}, {2, 3, 2}, {1, 4, 3}};
  const Mesh pipe = make_pipe(bent, 0.2f, 16);
  EXPECT_TRUE(closed(pipe));
  EXPECT_NEAR(volume(pipe), (2 + 2 + 3 + std::sqrt(3.0)) * 0.04 * polygon(16), 1e-5);
  // Every side face runs along its leg: a twist would make the surface larger.
  const double girth = 0.2 * 16 * 2 * std::sin(M_PI / 16);
  EXPECT_NEAR(surface(pipe), (2 + 2 + 3 + std::sqrt(3.0)) * girth + 2 * 0.04 * polygon(16), 1e-4);
}

TEST(Shapes, AppendTurnsMirroredFacesOutwards) {
  Mesh mesh;
  append(mesh, make_box(glm::vec3(0), glm::vec3(1)), {{-2, 0, 0}, {0, 1, 0}, {0, 0, 1}, {5, 0, 0}});
  EXPECT_TRUE(closed(mesh));
  EXPECT_NEAR(volume(mesh), 2, 1e-6);
}

RC_GTEST_PROP(Refine, PropertyKeepsShapeAndMeetsCount, ()) {
  const int kind = *rc::gen::inRange(0, 4);
  const glm::vec2 profile[] = {{2, 0}, {2, 1}, {1, 1}, {0, 6}};
  const Opening hole{1, 0, 2, 2};
  const Mesh mesh = kind == 0   ? make_box({0, 0, 0}, {1, 2, 3})
                    : kind == 1 ? make_ball(7, 4)
                    : kind == 2 ? make_lathe(profile, square_section())
                                : make_wall(5, 0, 3, 0.25f, {&hole, 1});
  const auto wanted = static_cast<std::size_t>(*rc::gen::inRange(1, 3000));
  const Mesh fine = refine(mesh, wanted);
  const std::size_t least = std::max(wanted, mesh.triangles.size());
  RC_ASSERT(fine.triangles.size() >= least && fine.triangles.size() <= least + 1);
  RC_ASSERT(closed(fine));
  RC_ASSERT(std::abs(volume(fine) - volume(mesh)) < 1e-5);
  RC_ASSERT(std::abs(surface(fine) - surface(mesh)) < 1e-4);
}

TEST(Refine, OpenMeshesStayWithinTheirEdges) {
  Mesh triangle;
  triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  triangle.triangles = {{0, 1, 2}};
  const Mesh fine = refine(triangle, 37);
  EXPECT_EQ(fine.triangles.size(), 37u);
  EXPECT_NEAR(surface(fine), 0.5, 1e-6);
}

TEST(Random, IsTheSameEverywhere) {
  // Pure integer arithmetic: any machine must give these numbers.
  Random random(42, 7);
  const std::uint64_t first = random.next(), second = random.next();
  Random again(42, 7), other(42, 8);
  EXPECT_EQ(again.next(), first);
  EXPECT_EQ(again.next(), second);
  EXPECT_NE(other.next(), first);
}

TEST(Random, RangesAreHalfOpenAndFilled) {
  Random random(1);
  int counts[10] = {};
  for (int i = 0; i < 10000; ++i) {
    const double u = random.uniform();
    ASSERT_TRUE(u >= 0 && u < 1);
    ++counts[static_cast<int>(u * 10)];
    const double r = random.power_of_two_range(-3, 2);
    ASSERT_TRUE(r >= 0.125 && r < 4);
    ASSERT_LT(random.below(3), 3u);
    ASSERT_NEAR(glm::length(random.direction()), 1.0, 1e-12);
  }
  for (const int count : counts) EXPECT_NEAR(count, 1000, 150);
}

TEST(CirclePoint, IsCosineAndSine) {
  for (int i = -3000; i <= 3000; ++i) {
    const double turns = i / 700.0;
    const glm::dvec2 p = circle_point(turns);
    ASSERT_NEAR(p.x, std::cos(2 * M_PI * turns), 1e-13) << turns;
    ASSERT_NEAR(p.y, std::sin(2 * M_PI * turns), 1e-13) << turns;
  }
  EXPECT_EQ(circle_point(0.25), glm::dvec2(0, 1));
  EXPECT_EQ(circle_point(-0.25), glm::dvec2(0, -1));
  EXPECT_EQ(circle_point(7.5), glm::dvec2(-1, 0));
}

}  // namespace
}  // namespace sightline
