// Clusters of normals: each formula of checklist 19.01-19.15 against what it bounds, E37-E39 and E52 among them.
#include "sightline/geometry/normal_cluster.hpp"

#include <gtest/gtest.h>

#include "properties.hpp"
#include "sightline/scene/generate/random.hpp"

namespace sightline {
namespace {

/// Triangles around a place whose normals lie around a direction.
std::vector<FacePlane> patch(Random& random, int count, double spread, double size, const glm::dvec3& place) {
  const glm::dvec3 direction = random.direction();
  std::vector<FacePlane> planes;
  while (static_cast<int>(planes.size()) < count) {
    const glm::dvec3 n = glm::normalize(direction + spread * random.direction());
    const glm::dvec3 u = glm::normalize(glm::cross(n, random.direction())), v = glm::cross(n, u),
                     p = place + size * random.direction();
    planes.push_back(face_plane(p, p + 0.1 * u, p + 0.1 * v));
  }
  return planes;
}

/// 19.01: max(x + y) <= max x + max y; max(x - y) <= max x - min y; max(k x) = k max x, or k min x for k < 0.
TEST(NormalCluster, MaximumRules) {
  Random random(1);
  for (int round = 0; round < 100; ++round) {
    double mx = -1e9, my = -1e9, ny = 1e9, nx = 1e9, sum = -1e9, difference = -1e9, scaled = -1e9;
    const double k = random.range(-2, 2);
    for (int i = 0; i < 9; ++i) {
      const double x = random.range(-1, 1), y = random.range(-1, 1);
      mx = std::max(mx, x), nx = std::min(nx, x), my = std::max(my, y), ny = std::min(ny, y);
      sum = std::max(sum, x + y), difference = std::max(difference, x - y), scaled = std::max(scaled, k * x);
    }
    EXPECT_LE(sum, mx + my);
    EXPECT_LE(difference, mx - ny);
    EXPECT_DOUBLE_EQ(scaled, k >= 0 ? k * mx : k * nx);
  }
}

/// 19.05: the operator picks by the sign of the eye's component.
TEST(NormalCluster, OctantSelect) { EXPECT_EQ(octant_select({1, -1, 0}, {1, 2, 3}, {4, 5, 6}), glm::vec3(1, 5, 3)); }

/// 19.02-19.05, 19.08, 19.11: what the cluster says holds for every one of its planes, for all nine origins.
TEST(NormalCluster, SaysOnlyWhatHoldsForAll) {
  Random random(2);
  std::size_t back = 0, front = 0;
  for (int round = 0; round < 300; ++round) {
    const glm::dvec3 place = random.range(0, 5) * random.direction();
    const auto planes = patch(random, 8, random.range(0, 0.8), random.range(0, 1), place);
    const Aabb bounds{glm::vec3(place) - 1.0f, glm::vec3(place) + 1.0f};
    for (int origin = -1; origin < 8; ++origin) {
      const NormalCluster cluster = make_cluster(planes, origin < 0 ? bounds.centre() : bounds.corner(origin));
      for (int i = 0; i < 20; ++i) {
        const glm::dvec3 eye(glm::vec3(random.range(0, 9) * random.direction()));
        const glm::vec4 e(glm::vec3(eye), 1.0f);
        if (turns_back(cluster, e, 1e-5f)) ++back;
        if (turns_front(cluster, e)) ++front;
        for (const FacePlane& plane : planes) {
          const double side = glm::dot(plane.normal, eye) - plane.offset;  // n . (e - p): back <= 0 (E35)
          if (turns_back(cluster, e, 1e-5f)) {
            EXPECT_LE(side, 0.0);
          }
          if (turns_front(cluster, e)) {
            EXPECT_GE(side, -1e-4);
          }
        }
        const glm::vec4 towards(glm::normalize(glm::vec3(eye) + 1e-6f), 0.0f);
        if (turns_back(cluster, towards, 1e-5f)) {
          for (const FacePlane& plane : planes) EXPECT_LE(glm::dot(plane.normal, glm::dvec3(towards)), 0.0);
        }
      }
    }
  }
  EXPECT_GT(back, 2000u);
  EXPECT_GT(front, 2000u);
}

/// 19.06 and E37: 28 bytes for the back test, 32 for both, 44 with a local origin; ours has 4 more for rounding.
TEST(NormalCluster, Bytes) { EXPECT_EQ(sizeof(NormalCluster), 44u + 4u); }

/// 19.08: far from the origin the test never succeeds about the world's origin, and does about a local one.
TEST(NormalCluster, LocalOriginRescuesWhatIsFarAway) {
  Random random(3);
  // A patch far away whose plane has the origin on its front side, seen from behind.
  std::vector<FacePlane> planes;
  for (int i = 0; i < 6; ++i) {
    const glm::dvec3 n = glm::normalize(glm::dvec3(-1, 0, 0) + 0.2 * random.direction()),
                     u = glm::normalize(glm::cross(n, glm::dvec3(0, 1, 0))), v = glm::cross(n, u);
    const glm::dvec3 p = glm::dvec3(1000, 0, 0) + random.direction();
    planes.push_back(face_plane(p, p + u, p + v));
  }
  const NormalCluster world = make_cluster(planes, {0, 0, 0}), local = make_cluster(planes, {1000, 0, 0});
  const glm::vec4 behind(1010, 0, 0, 1);
  EXPECT_LT(world.d, -900.0f);
  EXPECT_FALSE(turns_back(world, behind, 0.0f));
  EXPECT_TRUE(turns_back(local, behind, 0.0f));
}

/// 19.07: the culling volume meets the half axes at (d / m_x, 0, 0) and so on.
TEST(NormalCluster, CullingVolumeMeetsTheAxes) {
  NormalCluster cluster;
  cluster.n = {-0.5f, -0.25f, -1.0f};
  cluster.m = {0.5f, 1.0f, 0.25f};
  cluster.d = 2.0f;
  for (int axis = 0; axis < 3; ++axis) {
    glm::vec4 e(0, 0, 0, 1);
    e[axis] = cluster.d / cluster.m[axis] * 0.999f;
    EXPECT_TRUE(turns_back(cluster, e, 0.0f));
    e[axis] = cluster.d / cluster.m[axis] * 1.001f;
    EXPECT_FALSE(turns_back(cluster, e, 0.0f));
    e[axis] = cluster.d / cluster.n[axis] * 0.999f;
    EXPECT_TRUE(turns_back(cluster, e, 0.0f));
    e[axis] = cluster.d / cluster.n[axis] * 1.001f;
    EXPECT_FALSE(turns_back(cluster, e, 0.0f));
  }
  // 19.12: its exact volume is that of eight tetrahedra, (a+ + a-) (b+ + b-) (c+ + c-) / 6 of the half axes.
  EXPECT_NEAR(culling_volume(cluster), (4 + 4) * (2 + 8) * (8 + 2) / 6.0, 1e-5);
  EXPECT_NEAR(culling_volume(cluster, {{-20, -20, -20}, {20, 20, 20}}), culling_volume(cluster), 1e-4);
  cluster.m.x = -0.1f;
  EXPECT_TRUE(std::isinf(culling_volume(cluster)));  // open towards +x
  cluster.m.x = 0.5f;
  cluster.d = -0.1f;
  EXPECT_EQ(culling_volume(cluster), 0.0);
}

/// 19.12: Vol(C) within U against counting.
TEST(NormalCluster, CullingProbabilityIsTheShareOfViewpoints) {
  Random random(4);
  for (int round = 0; round < 40; ++round) {
    const glm::dvec3 place = 2.0 * random.direction();
    const auto planes = patch(random, 6, random.range(0, 0.7), 0.5, place);
    const NormalCluster cluster = make_cluster(planes, glm::vec3(place));
    const Aabb viewpoints{glm::vec3(place) - glm::vec3(3, 2, 4), glm::vec3(place) + glm::vec3(2, 5, 3)};
    int in = 0;
    constexpr int tries = 20000;
    for (int i = 0; i < tries; ++i) {
      const glm::vec3 e(random.range(viewpoints.lo.x, viewpoints.hi.x), random.range(viewpoints.lo.y, viewpoints.hi.y),
                        random.range(viewpoints.lo.z, viewpoints.hi.z));
      in += turns_back(cluster, glm::vec4(e, 1.0f), 0.0f) ? 1 : 0;
    }
    EXPECT_NEAR(culling_probability(cluster, viewpoints), in / static_cast<double>(tries), 0.015);
  }
}

TEST(NormalCluster, VolumeBelowAPlane) {
  const Aabb unit{glm::vec3(0), glm::vec3(1)};
  EXPECT_DOUBLE_EQ(volume_below(unit, {1, 0, 0}, 0.25), 0.25);
  EXPECT_NEAR(volume_below(unit, {1, 1, 1}, 1.0), 1.0 / 6.0, 1e-12);
  EXPECT_NEAR(volume_below(unit, {1, 1, 1}, 1.5), 0.5, 1e-12);
  EXPECT_NEAR(volume_below(unit, {-1, 0, 0}, -0.25), 0.75, 1e-12);
  EXPECT_EQ(volume_below(unit, {0, 0, 0}, 1.0), 1.0);
  EXPECT_EQ(volume_below(unit, {1, 2, 3}, -0.1), 0.0);
  EXPECT_EQ(volume_below(unit, {1, 2, 3}, 6.1), 1.0);
  EXPECT_EQ(volume_below({}, {1, 2, 3}, 1.0), 0.0);
}

/// 19.10, E38: merging bounds both, whatever the local origins; the recomputed cluster is at least as tight.
TEST(NormalCluster, MergedIsConservative) {
  Random random(6);
  for (int round = 0; round < 300; ++round) {
    const glm::dvec3 place = random.range(0, 3) * random.direction(),
                     other = place + random.range(0, 3) * random.direction();
    const auto a = patch(random, 5, random.range(0, 0.5), 0.3, place),
               b = patch(random, 5, random.range(0, 0.5), 0.3, other);
    const NormalCluster first = make_cluster(a, glm::vec3(place)), second = make_cluster(b, glm::vec3(other)),
                        both = merge(first, second);
    std::vector<FacePlane> planes = a;
    planes.insert(planes.end(), b.begin(), b.end());
    const NormalCluster recomputed = make_cluster(planes, glm::vec3(place));
    EXPECT_LE(both.d, recomputed.d);
    EXPECT_GE(both.front, recomputed.front);
    for (int i = 0; i < 40; ++i) {
      const glm::vec4 e(glm::vec3(random.range(0, 12) * random.direction()), 1.0f);
      if (turns_back(both, e, 1e-5f)) {
        EXPECT_TRUE(turns_back(first, e, 0.0f));
        EXPECT_TRUE(turns_back(second, e, 0.0f));
        EXPECT_TRUE(turns_back(recomputed, e, 0.0f));
      }
    }
  }
}

/// E38's counter-example: the least of two d about different origins is no bound.
TEST(NormalCluster, LeastOfForeignOffsetsWouldBeWrong) {
  const std::vector<FacePlane> a{face_plane({0, 0, 0}, {0, 1, 0}, {0, 0, 1})},
      b{face_plane({-9, 0, 0}, {-9, 1, 0}, {-9, 0, 1})};
  const NormalCluster first = make_cluster(a, {0, 0, 0}), second = make_cluster(b, {-9, 0, 0}),
                      both = merge(first, second);
  EXPECT_EQ(std::min(first.d, second.d), 0.0f);
  EXPECT_LE(both.d, -9.0f + 1e-5f);
  EXPECT_FALSE(turns_back(both, {-4, 0, 0, 1}, 0.0f));  // the second one faces this eye
}

/// 19.14, 19.15, E39: one cluster is cheaper than two exactly if P(C) exceeds the threshold with -t_C.
TEST(NormalCluster, CostModelAndItsSign) {
  Random random(7);
  for (int round = 0; round < 1000; ++round) {
    const ClusterCost cost{random.range(0, 20)};
    const double pa = random.uniform(), pb = random.uniform(), pc = random.uniform();
    const double na = random.range(1, 100), nb = random.range(1, 100);
    EXPECT_EQ(cost.of(pc, na + nb) < cost.of(pa, na) + cost.of(pb, nb), pc > cost.merge_threshold(pa, na, pb, nb));
  }
  // The dearer the test, the sooner one merges; the slide's +t_C would say the opposite.
  EXPECT_LT(ClusterCost{9}.merge_threshold(0.4, 10, 0.4, 10), ClusterCost{1}.merge_threshold(0.4, 10, 0.4, 10));
}

TEST(NormalCluster, NearFieldIsAScaledBox) {
  const Aabb field = near_field({{0, 0, 0}, {2, 4, 6}}, 3.0f);  // 19.13: the factor scales about the centre (E52)
  EXPECT_EQ(field.lo, glm::vec3(-2, -4, -6));
  EXPECT_EQ(field.hi, glm::vec3(4, 8, 12));
  EXPECT_TRUE(near_field({}, 2.0f).empty());
  EXPECT_GT(near_field({{0, 0, 0}, {1, 0, 1}}, 2.0f).extent().y, 0.0f);
}

TEST(NormalCluster, BestOriginIsBestOfNine) {
  Random random(8);
  for (int round = 0; round < 50; ++round) {
    const auto planes = patch(random, 9, 0.6, 1.0, {0, 0, 0});
    const Aabb bounds{glm::vec3(-1), glm::vec3(1)}, viewpoints = near_field(bounds, 3.0f);
    const double best = culling_probability(best_cluster(planes, bounds, viewpoints), viewpoints);
    EXPECT_GE(best, culling_probability(make_cluster(planes, bounds.centre()), viewpoints));
    for (int i = 0; i < 8; ++i)
      EXPECT_GE(best, culling_probability(make_cluster(planes, bounds.corner(i)), viewpoints));
  }
}

TEST(NormalCluster, NothingWithoutArea) {
  const std::vector<FacePlane> none(3);
  const NormalCluster cluster = make_cluster(none, {0, 0, 0});
  EXPECT_TRUE(std::isinf(cluster.sharpness));
}

}  // namespace
}  // namespace sightline
