// Column casting against the oracle on the extruded map, and what the missing fisheye correction costs.
#include "sightline/surface/column_cast.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sightline/oracle/oracle.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/input_error.hpp"

namespace sightline {
namespace {

/// A horizontal view from the middle of a random empty cell, or anywhere in it.
View view_in(const GridMap& map, Random& random) {
  int x = 0, z = 0;
  do {
    x = static_cast<int>(random.below(static_cast<std::uint32_t>(map.width)));
    z = static_cast<int>(random.below(static_cast<std::uint32_t>(map.depth)));
  } while (map.at(x, z) != 0);
  const double angle = random.range(0, 6.28);
  const glm::dvec3 eye(map.cell * (x + random.range(0.05, 0.95)), map.height * random.range(0.1, 0.9),
                       map.cell * (z + random.range(0.05, 0.95)));
  View view = look_along(eye, {std::cos(angle), 0, std::sin(angle)});
  view.width = 160;
  view.height = 100;
  view.fov_y = random.range(0.6, 1.6);
  view.near = 0.001;
  view.far = 500;
  return view;
}

TEST(ColumnCast, IdsAndDepthAreThoseOfTheExtrudedScene) {
  Random random(3);
  for (const float cell : {1.0f, 3.0f, 0.7f}) {
    GridMap map = make_maze(21, 15, 5, 0.3);
    map.cell = cell;
    map.height = 1.3f;
    const Scene scene = extrude(map);
    const Oracle oracle(scene);
    std::size_t wrong = 0, edges = 0, pixels = 0;
    for (int i = 0; i < 20; ++i) {
      const View view = view_in(map, random);
      Frame truth, frame;
      Counters counters;
      oracle.draw(view, truth);
      column_cast(map, view, {}, frame, counters);
      for (std::size_t at = 0; at < truth.object.size(); ++at) {
        const bool same_depth = std::abs(frame.depth[at] - truth.depth[at]) <= 1e-4f * truth.depth[at];
        ++pixels;
        if (frame.object[at] == truth.object[at] && same_depth) continue;
        // At the line between wall, floor and ceiling and at the seam of two walls: equal depth, either object.
        (same_depth ? edges : wrong) += 1;
      }
      EXPECT_GE(counters.nodes_visited, 160u);
    }
    EXPECT_LE(wrong * 10000, pixels) << "cell " << cell;
    EXPECT_LE(edges * 200, pixels);
  }
}

TEST(ColumnCast, AsksOnceForAColumn) {  // 13.19: where a real ray caster asks for every pixel
  Random random(4);
  const GridMap map = make_maze(21, 15, 5, 0.3);
  const Scene scene = extrude(map);
  const IndexedScene indexed = index_scene(scene);
  const auto rays = make_renderer("ray_cast", indexed);
  std::uint64_t columns = 0, pixels = 0;
  for (int i = 0; i < 10; ++i) {
    const View view = view_in(map, random);
    Frame frame;
    Counters walked, traced;
    column_cast(map, view, {}, frame, walked);
    rays->draw(view, VisibleSet::all(scene.objects().size()), frame, traced);
    columns += walked.nodes_visited;
    pixels += traced.nodes_visited;
  }
  EXPECT_LT(columns * 10, pixels);
}

TEST(ColumnCast, WithoutCorrectionStraightWallsBulge) {  // 13.18
  GridMap map;
  map.width = 20;
  map.depth = 10;
  map.walls.assign(200, 0);
  for (int x = 0; x < 20; ++x) map.walls[map.index(x, 9)] = 1;
  View view = look_along({10, 0.5, 6}, {0, 0, 1});
  view.width = 201;
  view.height = 101;
  view.fov_y = 0.9;
  view.near = 0.01;
  const auto wall_rows = [&](const Frame& frame, int x) {
    int rows = 0;
    for (int y = 0; y < frame.height; ++y) {
      const ObjectId id = frame.object[frame.index(x, y)];
      rows += id != no_object && id < 20 ? 1 : 0;
    }
    return rows;
  };
  Frame right, bent;
  Counters counters;
  column_cast(map, view, {}, right, counters);
  ColumnCastConfig fisheye;
  fisheye.correct_fisheye = false;
  column_cast(map, view, fisheye, bent, counters);
  EXPECT_EQ(wall_rows(right, 0), wall_rows(right, 100)) << "a wall across the view is equally high everywhere";
  EXPECT_EQ(wall_rows(bent, 100), wall_rows(right, 100)) << "the middle column has no error";
  // At the left border the ray is longer by 1 / cos of its angle, and the wall lower by that much.
  const double half = std::tan(0.45) * 200.0 / 101.0;
  EXPECT_NEAR(wall_rows(bent, 0), wall_rows(right, 0) / std::sqrt(1 + half * half), 1.5);
  EXPECT_LT(wall_rows(bent, 0), 0.8 * wall_rows(right, 0));
}

TEST(ColumnCast, MazesAreClosedAndConnected) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const GridMap map = make_maze(31, 21, seed, 0.05);
    std::vector<char> reached(map.walls.size(), 0);
    std::vector<glm::ivec2> stack{{1, 1}};
    std::size_t count = 0;
    while (!stack.empty()) {
      const glm::ivec2 p = stack.back();
      stack.pop_back();
      ASSERT_GT(p.x * p.y, 0);
      ASSERT_LT(p.x, map.width - 1);
      ASSERT_LT(p.y, map.depth - 1);
      if (reached[map.index(p.x, p.y)] != 0) continue;
      reached[map.index(p.x, p.y)] = 1;
      ++count;
      for (const glm::ivec2& d : {glm::ivec2(1, 0), glm::ivec2(-1, 0), glm::ivec2(0, 1), glm::ivec2(0, -1)})
        if (map.at(p.x + d.x, p.y + d.y) == 0) stack.push_back(p + d);
    }
    EXPECT_EQ(count, static_cast<std::size_t>(std::count(map.walls.begin(), map.walls.end(), 0)));
    EXPECT_EQ(make_maze(31, 21, seed, 0.05).walls, map.walls);
  }
}

TEST(ColumnCast, RefusesWhatItCannotShow) {
  const GridMap map = make_maze(9, 9, 1);
  Frame frame;
  Counters counters;
  const auto refuses = [&](const View& view) { EXPECT_THROW(column_cast(map, view, {}, frame, counters), InputError); };
  View good = look_along({1.5, 0.5, 1.5}, {1, 0, 0.3});
  EXPECT_NO_THROW(column_cast(map, good, {}, frame, counters));
  refuses(look_along({1.5, 0.5, 1.5}, {1, 0.1, 0}));
  refuses(look_along({1.5, 1.5, 1.5}, {1, 0, 0}));
  refuses(look_along({0.5, 0.5, 0.5}, {1, 0, 0}));
  View flat = good;
  flat.projection = Projection::orthographic;
  refuses(flat);
  GridMap broken = map;
  broken.walls.pop_back();
  EXPECT_THROW(column_cast(broken, good, {}, frame, counters), InputError);
  EXPECT_THROW(extrude(broken), InputError);
  // From outside of the map there is something to see, too: walls without floor before them.
  EXPECT_NO_THROW(column_cast(map, look_along({-3, 0.5, 4.5}, {1, 0, 0}), {}, frame, counters));
}

}  // namespace
}  // namespace sightline
