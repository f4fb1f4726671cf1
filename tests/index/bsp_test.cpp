// BSP trees: the worked example, invariants of every tree, depth order, collisions and leaves against brute force. So
// many lines because all of them share the trees and the brute force they are compared with.
#include "sightline/index/bsp.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>

#include "properties.hpp"
#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/generate/shapes.hpp"

namespace sightline {
namespace {

constexpr BspSplitter every_splitter[] = {BspSplitter::first,   BspSplitter::random, BspSplitter::fewest_splits,
                                          BspSplitter::balance, BspSplitter::mixed,  BspSplitter::pca};

void add_mesh(PolygonSet& set, const Mesh& mesh, const glm::dmat3& linear = glm::dmat3(1.0),
              const glm::dvec3& place = glm::dvec3(0.0)) {
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 corners[3] = {linear * glm::dvec3(mesh.positions[t.x]) + place,
                                   linear * glm::dvec3(mesh.positions[t.y]) + place,
                                   linear * glm::dvec3(mesh.positions[t.z]) + place};
    set.add(corners);
  }
}

/// Triangles anywhere in a cube, of all sizes, through each other.
PolygonSet soup(int n, std::uint64_t seed, double size = 1.0) {
  Random random(seed);
  PolygonSet set;
  for (int i = 0; i < n; ++i) {
    const glm::dvec3 centre(random.range(-5, 5), random.range(-5, 5), random.range(-5, 5));
    const double scale = size * random.power_of_two_range(-4, 2);
    const glm::dvec3 corners[3] = {centre + scale * random.direction(), centre + scale * random.direction(),
                                   centre + scale * random.direction()};
    set.add(corners);
  }
  return set;
}

double area(std::span<const glm::dvec3> p) {
  glm::dvec3 sum(0.0);
  for (std::size_t i = 2; i < p.size(); ++i) sum += glm::cross(p[i - 1] - p[0], p[i] - p[0]);
  return 0.5 * glm::length(sum);
}

std::vector<glm::dvec3> points(const Bsp& bsp, const BspFragment& fragment) {
  std::vector<glm::dvec3> result;
  for (const BspCorner& corner : bsp.corners_of(fragment)) result.push_back(corner.position);
  return result;
}

/// What every tree promises: fragments cover their sources, keep their sense of rotation, and lie where the tree says.
void expect_sound(const Bsp& bsp) {
  std::vector<double> covered(bsp.polygons.size(), 0.0);
  for (const BspFragment& fragment : bsp.fragments) {
    const std::vector<glm::dvec3> p = points(bsp, fragment);
    ASSERT_GE(p.size(), 3u);
    const glm::dvec3 normal = bsp.planes[fragment.source].normal;
    const double a = area(p);
    if (a > 1e-6) {
      ASSERT_GT(glm::dot(plane_of(p).normal, normal), 0.999) << "a fragment turned around";
    }
    covered[fragment.source] += a;
  }
  for (std::size_t i = 0; i < covered.size(); ++i) {
    const double whole = bsp.planes[i].normal == glm::dvec3(0.0) ? 0.0 : area(bsp.polygons[i]);
    ASSERT_NEAR(covered[i], whole, 1e-8 * (1.0 + whole)) << "polygon " << i;
  }
  // Every fragment against every node above it.
  const double slack = 4 * bsp.tolerance;
  std::vector<std::pair<std::uint32_t, std::vector<std::pair<std::uint32_t, bool>>>> stack{{0, {}}};
  while (!stack.empty() && !bsp.nodes.empty()) {
    auto [index, path] = std::move(stack.back());
    stack.pop_back();
    const BspNode& node = bsp.nodes[index];
    for (const BspFragment& fragment : bsp.fragments_of(node))
      for (const BspCorner& corner : bsp.corners_of(fragment)) {
        ASSERT_LE(std::abs(node.plane.at(corner.position)), slack);
        for (const auto& [above, front] : path)
          ASSERT_GE((front ? 1.0 : -1.0) * bsp.nodes[above].plane.at(corner.position), -slack);
      }
    for (const bool front : {true, false}) {
      const std::uint32_t child = front ? node.front : node.back;
      if (is_bsp_leaf(child)) continue;
      auto longer = path;
      longer.emplace_back(index, front);
      stack.emplace_back(child, std::move(longer));
    }
  }
}

/// A segment of the plan as an upright wall.
void add_wall(PolygonSet& set, const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec3 corners[4] = {{a, 0}, {b, 0}, {b, 1}, {a, 1}};
  set.add(corners);
}

/// The example of the lecture (15.06): polygons 1 to 5, the root is 3, then 2 and 4b, then 1b; 4 falls into 4a and 4b
/// at the plane of 3, 1 into 1a and 1b at that of 2.
struct WorkedExample {
  Bsp bsp;
  glm::dvec4 eye{-4, -1.5, 0.5, 1};
  WorkedExample() {
    PolygonSet set;
    add_wall(set, {-1, 0}, {1, 0});        // 3
    add_wall(set, {0, -2}, {0, -1});       // 2
    add_wall(set, {-2, -3}, {2, -3});      // 1
    add_wall(set, {3, -1.5}, {3.5, 1.5});  // 4
    add_wall(set, {-1, 2}, {1, 2.5});      // 5
    BspConfig config;
    config.splitter = BspSplitter::first;
    bsp = build_bsp(set, config);
  }
  [[nodiscard]] std::string name(const BspFragment& fragment) const {
    constexpr const char* names[] = {"3", "2", "1", "4", "5"};
    const glm::dvec3 at = bsp.corners_of(fragment)[0].position, other = bsp.corners_of(fragment)[1].position;
    const std::string part = fragment.source == 2   ? (at.x + other.x < 0 ? "a" : "b")
                             : fragment.source == 3 ? (at.y + other.y < 0 ? "a" : "b")
                                                    : "";
    return names[fragment.source] + part;
  }
  [[nodiscard]] std::vector<std::string> order(BspOrder order) const {
    std::vector<std::string> result;
    walk_bsp(bsp, eye, order, [&](std::uint32_t node) {
      for (const BspFragment& fragment : bsp.fragments_of(bsp.nodes[node])) result.push_back(name(fragment));
    });
    return result;
  }
};

TEST(Bsp, WorkedExampleHasItsTreeAndItsOrder) {
  const WorkedExample example;
  expect_sound(example.bsp);
  ASSERT_EQ(example.bsp.nodes.size(), 7u);
  const auto name_of = [&](std::uint32_t node) {
    return is_bsp_leaf(node) ? "-" : example.name(example.bsp.fragments_of(example.bsp.nodes[node])[0]);
  };
  const BspNode& root = example.bsp.nodes[0];
  EXPECT_EQ(name_of(0), "3");
  const std::uint32_t two = name_of(root.front) == "2" ? root.front : root.back;
  const std::uint32_t four = two == root.front ? root.back : root.front;
  EXPECT_EQ(name_of(two), "2");
  EXPECT_EQ(name_of(four), "4b");
  const BspNode& second = example.bsp.nodes[two];
  EXPECT_TRUE(name_of(second.front) == "1b" || name_of(second.back) == "1b");
  const std::vector<std::string> expected{"4b", "5", "3", "1b", "4a", "2", "1a"};  // 15.08
  EXPECT_EQ(example.order(BspOrder::far_to_near), expected);
  std::vector<std::string> reversed(expected.rbegin(), expected.rend());
  EXPECT_EQ(example.order(BspOrder::near_to_far), reversed);  // 15.09
}

TEST(Bsp, EverySplitterBuildsSoundTrees) {
  for (const BspSplitter splitter : every_splitter)
    for (const std::uint64_t seed : {1, 2, 3}) {
      BspConfig config;
      config.splitter = splitter;
      config.seed = seed;
      const Bsp bsp = build_bsp(soup(150, seed), config);
      expect_sound(bsp);
      const Bsp again = build_bsp(soup(150, seed), config);
      ASSERT_EQ(again.fragments.size(), bsp.fragments.size());
      for (std::size_t i = 0; i < bsp.nodes.size(); ++i)
        ASSERT_EQ(again.nodes[i].plane.normal, bsp.nodes[i].plane.normal);
    }
}

TEST(Bsp, SplittersDoWhatTheirNamesSay) {
  const PolygonSet set = soup(400, 4);
  const auto tree = [&](BspSplitter splitter) {
    BspConfig config;
    config.splitter = splitter;
    return build_bsp(set, config);
  };
  const Bsp random = tree(BspSplitter::random), fewest = tree(BspSplitter::fewest_splits),
            balance = tree(BspSplitter::balance);
  EXPECT_LT(fewest.fragments.size(), random.fragments.size());
  EXPECT_LT(balance.depth, random.depth);
  EXPECT_LT(balance.depth, fewest.depth);
  EXPECT_GE(random.fragments.size(), set.size());
}

TEST(Bsp, SplitKeepsOrientationAndCountsPartsByTheirCorners) {
  const BspPlane plane{{0, 0, 1}, 0};
  std::vector<BspCorner> front, back;
  const auto split = [&](std::initializer_list<double> heights) {
    std::vector<BspCorner> corners;
    const glm::dvec2 places[] = {{0, 0}, {4, 0}, {0, 4}};
    std::size_t i = 0;
    for (const double z : heights) corners.push_back({{places[i++], z}, no_cut});
    return split_polygon(corners, plane, 7, 1e-12, front, back);
  };
  // R alone in front: a triangle there, a quadrilateral (two triangles: t1, t2) behind (15.10); A = P + t (R - P).
  ASSERT_EQ(split({-1, -1, 3}), BspSide::both);
  EXPECT_EQ(front.size(), 3u);
  EXPECT_EQ(back.size(), 4u);
  EXPECT_EQ(front[0].position, glm::dvec3(3, 1, 0));  // on Q R: t = 1 / 4
  ASSERT_EQ(split({1, 1, -3}), BspSide::both);        // the roles swap (E30)
  EXPECT_EQ(front.size(), 4u);
  EXPECT_EQ(back.size(), 3u);
  ASSERT_EQ(split({-1, 0, 2}), BspSide::both);  // through a corner: two triangles (E30)
  EXPECT_EQ(front.size(), 3u);
  EXPECT_EQ(back.size(), 3u);
  for (const auto* part : {&front, &back}) {
    std::vector<glm::dvec3> p;
    for (const BspCorner& c : *part) p.push_back(c.position);
    EXPECT_GT(plane_of(p).normal.z, 0.0);
    EXPECT_EQ(std::count_if(part->begin(), part->end(), [](const BspCorner& c) { return c.cut != no_cut; }), 1);
  }
  EXPECT_EQ(split({0, 0, 1}), BspSide::front);
  EXPECT_EQ(split({0, -2, 0}), BspSide::back);
  EXPECT_EQ(split({0, 1e-14, -1e-14}), BspSide::on);
}

TEST(Bsp, CoplanarPolygonsShareANodeWhicheverWayTheyFace) {
  PolygonSet set;
  const glm::dvec3 up[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, down[3] = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}},
                   apart[3] = {{5, 5, 0}, {6, 5, 0}, {5, 6, 0}};
  set.add(up);
  set.add(down);
  set.add(apart);
  const Bsp bsp = build_bsp(set);
  ASSERT_EQ(bsp.nodes.size(), 1u);
  ASSERT_EQ(bsp.fragments.size(), 3u);
  EXPECT_NE(bsp.fragments[0].along, bsp.fragments[1].along);
  EXPECT_EQ(bsp.fragments[0].source, 0u);
  EXPECT_EQ(bsp.fragments[2].source, 2u);
}

TEST(Bsp, DegenerateInput) {
  EXPECT_TRUE(build_bsp({}).nodes.empty());
  BspHit hit;
  EXPECT_FALSE(first_hit(build_bsp({}), {0, 0, 0}, {1, 1, 1}, hit));
  EXPECT_FALSE(is_inside(build_bsp({}), {0, 0, 0}));
  walk_bsp(build_bsp({}), {0, 0, 0, 1}, BspOrder::far_to_near, [](std::uint32_t) { FAIL(); });
  PolygonSet set;
  const glm::dvec3 line[3] = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, point[3] = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}},
                   good[3] = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, sliver[3] = {{0, 0, 0}, {1e6, 0, 0}, {5e5, 1e-3, 1e-3}};
  set.add(line);
  set.add(good);
  set.add(point);
  set.add(sliver);
  set.add(good);
  const Bsp bsp = build_bsp(set);
  EXPECT_EQ(bsp.dropped, 2u);
  expect_sound(bsp);
  BspConfig tight;
  tight.most_fragments = 5;
  EXPECT_THROW(build_bsp(soup(100, 1), tight), std::length_error);
}

/// Is there a point where `far` is hidden by `near`, as the walk from far to near must not have it the other way round?
/// Looks along rays from the eye through points of the fragment that comes first.
TEST(Bsp, NothingHidesWhatIsVisitedAfterIt) {
  Random random(11);
  for (const BspSplitter splitter : every_splitter) {
    BspConfig config;
    config.splitter = splitter;
    const Bsp bsp = build_bsp(soup(60, 21), config);
    for (int trial = 0; trial < 4; ++trial) {
      glm::dvec3 eye(random.range(-6, 6), random.range(-6, 6), random.range(-6, 6));
      if (trial == 3) eye = bsp.polygons[5][0] + 0.3 * (bsp.polygons[5][1] - bsp.polygons[5][0]);  // in a plane
      std::vector<const BspFragment*> order;
      walk_bsp(bsp, {eye, 1}, BspOrder::near_to_far, [&](std::uint32_t node) {
        for (const BspFragment& f : bsp.fragments_of(bsp.nodes[node])) order.push_back(&f);
      });
      ASSERT_EQ(order.size(), bsp.fragments.size());
      for (std::size_t late = 0; late < order.size(); ++late) {
        const std::vector<glm::dvec3> p = points(bsp, *order[late]);
        const glm::dvec3 centre = std::accumulate(p.begin(), p.end(), glm::dvec3(0)) / static_cast<double>(p.size());
        for (std::size_t after = late + 1; after < order.size(); ++after) {
          // Between the eye and the centre of an earlier (nearer) fragment there is no later one.
          const std::vector<glm::dvec3> q = points(bsp, *order[after]);
          double t = 0;
          const bool met = segment_meets_polygon(eye, centre, q, bsp.planes[order[after]->source], 0.0, t);
          ASSERT_FALSE(met && t > 1e-9 && t < 1 - 1e-7) << late << " " << after;
        }
      }
    }
  }
}

TEST(Bsp, EyeAtInfinitySortsAlongADirection) {
  PolygonSet set;
  for (int i = 0; i < 20; ++i) {
    const double z = (i * 7) % 20;
    const glm::dvec3 corners[3] = {{0, 0, z}, {1, 0, z}, {0, 1, z}};
    set.add(corners);
  }
  const Bsp bsp = build_bsp(set);
  double last = 100;
  walk_bsp(bsp, {0, 0, 1, 0}, BspOrder::near_to_far, [&](std::uint32_t node) {
    for (const BspFragment& f : bsp.fragments_of(bsp.nodes[node])) {
      const double z = bsp.polygons[f.source][0].z;
      EXPECT_LT(z, last);
      last = z;
    }
  });
  EXPECT_EQ(last, 0.0);
}

TEST(Bsp, FirstHitIsThatOfBruteForce) {
  Random random(5);
  for (const BspSplitter splitter : every_splitter) {
    BspConfig config;
    config.splitter = splitter;
    const Bsp bsp = build_bsp(soup(200, 8), config);
    int hits = 0;
    for (int i = 0; i < 3000; ++i) {
      const glm::dvec3 from(random.range(-6, 6), random.range(-6, 6), random.range(-6, 6));
      glm::dvec3 to(random.range(-6, 6), random.range(-6, 6), random.range(-6, 6));
      if (i % 5 == 0) to = bsp.polygons[random.below(200)][random.below(3)];  // ends at a corner
      bool found = false;
      BspHit expected, hit;
      for (std::uint32_t k = 0; k < bsp.polygons.size(); ++k) {
        double t = 0;
        if (!segment_meets_polygon(from, to, bsp.polygons[k], bsp.planes[k], bsp.tolerance, t)) continue;
        if (!found || t < expected.t) expected = {t, k};
        found = true;
      }
      ASSERT_EQ(first_hit(bsp, from, to, hit), found) << i;
      if (!found) continue;
      ++hits;
      ASSERT_EQ(hit.t, expected.t);
      ASSERT_EQ(hit.source, expected.source);
    }
    EXPECT_GT(hits, 1500);
  }
}

TEST(Bsp, TouchingAndInPlaneSegmentsHit) {  // what checkColl leaves undefined (E31)
  PolygonSet set;
  const glm::dvec3 wall[4] = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
  set.add(wall);
  const Bsp bsp = build_bsp(set);
  const auto t_of = [&](const glm::dvec3& a, const glm::dvec3& b) {
    BspHit hit;
    return first_hit(bsp, a, b, hit) ? hit.t : -1.0;
  };
  EXPECT_EQ(t_of({1, 1, 1}, {1, 1, -1}), 0.5);
  EXPECT_EQ(t_of({1, 1, 1}, {1, 1, 0}), 1.0);            // ends on it
  EXPECT_EQ(t_of({1, 1, 0}, {1, 1, 5}), 0.0);            // begins on it
  EXPECT_NEAR(t_of({-1, 1, 0}, {1, 1, 0}), 0.5, 1e-11);  // runs into it within its plane
  EXPECT_EQ(t_of({1, 1, 0}, {2, 2, 0}), 0.0);            // within it
  EXPECT_EQ(t_of({2, 2, 0}, {2, 2, 0}), 0.0);            // a point on it
  EXPECT_EQ(t_of({0, 0, 1}, {0, 0, -1}), 0.5);           // through a corner
  EXPECT_EQ(t_of({-1, -1, 0}, {-1, 9, 0}), -1);          // in its plane, beside it
  EXPECT_EQ(t_of({1, 1, 1}, {1, 1, 0.1}), -1);           // too short
  EXPECT_EQ(t_of({9, 1, 1}, {9, 1, -1}), -1);            // beside it
  EXPECT_EQ(t_of({5, 5, 5}, {5, 5, 5}), -1);
}

TEST(Bsp, LeavesOfAClosedSolidAreInsideAndOutside) {
  Random random(3);
  const glm::dmat3 turn = glm::mat3_cast(glm::angleAxis(0.5, glm::normalize(glm::dvec3(1, 2, 3))));
  // A concave solid: a wall with two openings. Its truth is arithmetic on its grid.
  const float u[] = {0, 1, 2, 3, 4, 5}, v[] = {0, 1, 2, 3};
  const char filled[] = {1, 1, 1, 1, 1, 1, 0, 1, 0, 1, 1, 1, 1, 1, 1};
  const Mesh plate = make_plate(u, v, filled, 1.0f);
  for (const BspSplitter splitter : every_splitter) {
    PolygonSet set;
    add_mesh(set, plate, turn);
    BspConfig config;
    config.splitter = splitter;
    config.free_planes_above = 4;
    const Bsp bsp = build_bsp(set, config);
    int inside = 0;
    for (int i = 0; i < 4000; ++i) {
      const glm::dvec3 p(random.range(-1, 6), random.range(-1, 4), random.range(-1, 1));
      const int column = static_cast<int>(std::floor(p.x)), row = static_cast<int>(std::floor(p.y));
      const bool in =
          column >= 0 && column < 5 && row >= 0 && row < 3 && filled[row * 5 + column] != 0 && std::abs(p.z) < 0.5;
      ASSERT_EQ(is_inside(bsp, turn * p), in) << i;
      inside += in ? 1 : 0;
    }
    EXPECT_GT(inside, 500);
  }
}

/// A convex polyhedron's planes have everything else behind: the tree of polygon planes is one chain.
TEST(Bsp, ConvexChainIsBuilt) {
  const Mesh ball = make_ball(100, 50);
  PolygonSet set;
  add_mesh(set, ball);
  BspConfig config;
  config.splitter = BspSplitter::random;
  const Bsp chain = build_bsp(set, config);
  EXPECT_GT(chain.depth, set.size() / 2);
  config.splitter = BspSplitter::mixed;
  const Bsp mixed = build_bsp(set, config);
  EXPECT_LT(mixed.depth, 200u) << "free planes keep the tree shallow";
  EXPECT_LT(mixed.fragments.size(), 3 * set.size());
  EXPECT_TRUE(is_inside(chain, {0.1, 0.2, 0.3}));
  EXPECT_TRUE(is_inside(mixed, {0.1, 0.2, 0.3}));
  EXPECT_FALSE(is_inside(chain, {0.9, 0.9, 0.3}));
}

TEST(Bsp, AChainOfAMillionNodesDoesNotExhaustTheStack) {
  // Parallel walls, each behind the one before it: the order of the input makes a chain of any builder that takes the
  // first polygon. Put together by hand, as building it takes n^2 / 2 tests.
  constexpr std::uint32_t n = 1'000'000;
  Bsp bsp;
  bsp.tolerance = 1e-12;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double z = -static_cast<double>(i);
    const glm::dvec3 corners[3] = {{0, 0, z}, {1, 0, z}, {0, 1, z}};
    bsp.polygons.add(corners);
    bsp.planes.push_back({{0, 0, 1}, -z});
    bsp.fragments.push_back({3 * i, 3, i, true});
    for (const glm::dvec3& p : corners) bsp.corners.push_back({p, no_cut});
    bsp.nodes.push_back({bsp.planes.back(), bsp_outside, i + 1 < n ? i + 1 : bsp_inside, i, 1});
  }
  for (const BspOrder order : {BspOrder::near_to_far, BspOrder::far_to_near}) {
    std::uint32_t visited = 0;
    walk_bsp(bsp, {0.5, 0.5, -5e5, 1}, order, [&](std::uint32_t) { ++visited; });
    EXPECT_EQ(visited, n);
  }
  BspHit hit;
  ASSERT_TRUE(first_hit(bsp, {0.1, 0.1, -2e6}, {0.1, 0.1, 5}, hit));
  EXPECT_EQ(hit.source, n - 1);
  EXPECT_TRUE(is_inside(bsp, {0, 0, -2e6}));
}

RC_GTEST_PROP(BspProperty, TreesAreSoundAndHitsAreThoseOfBruteForce, ()) {
  Random random(*rc::gen::arbitrary<std::uint64_t>());
  // Corners on a small grid: many coplanar, touching, duplicated and degenerate polygons.
  PolygonSet set;
  const int n = *rc::gen::inRange(1, 40);
  const auto grid = [&] { return glm::dvec3(random.below(4), random.below(4), random.below(4)); };
  for (int i = 0; i < n; ++i) {
    const glm::dvec3 corners[3] = {grid(), grid(), grid()};
    set.add(corners);
  }
  BspConfig config;
  config.splitter = every_splitter[random.below(6)];
  config.free_planes_above = 5;
  const Bsp bsp = build_bsp(set, config);
  expect_sound(bsp);
  for (int i = 0; i < 20; ++i) {
    const glm::dvec3 from = grid(), to = grid();
    bool found = false;
    double first = 2;
    for (std::uint32_t k = 0; k < set.size(); ++k) {
      double t = 0;
      if (bsp.planes[k].normal == glm::dvec3(0.0)) continue;
      if (segment_meets_polygon(from, to, set[k], bsp.planes[k], bsp.tolerance, t)) first = std::min(first, t);
      found = first < 2;
    }
    BspHit hit;
    RC_ASSERT(first_hit(bsp, from, to, hit) == found);
    RC_ASSERT(!found || hit.t == first);
  }
}

}  // namespace
}  // namespace sightline
