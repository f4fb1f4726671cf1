#include "sightline/scene/grid_map.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/generate/shapes.hpp"
#include "sightline/scene/input_error.hpp"

namespace sightline {

void check_grid_map(const GridMap& map) {
  constexpr int most = 4096;
  if (map.width < 1 || map.width > most || map.depth < 1 || map.depth > most)
    throw InputError("a grid map has 1 to 4096 cells along each side");
  if (!(map.cell > 0.0f) || !(map.height > 0.0f) || !std::isfinite(map.cell) || !std::isfinite(map.height))
    throw InputError("cell and height of a grid map must be above 0");
  if (map.walls.size() != static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.depth))
    throw InputError("a grid map needs width * depth cells");
}

GridMap make_maze(int width, int depth, std::uint64_t seed, double loops) {
  GridMap map;
  map.width = std::max(5, width - 1 + width % 2);
  map.depth = std::max(5, depth - 1 + depth % 2);
  map.walls.assign(static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.depth), 1);
  check_grid_map(map);
  Random random(seed);
  constexpr glm::ivec2 steps[] = {{2, 0}, {-2, 0}, {0, 2}, {0, -2}};
  std::vector<glm::ivec2> way{{1, 1}};
  map.walls[map.index(1, 1)] = 0;
  while (!way.empty()) {
    const glm::ivec2 here = way.back();
    glm::ivec2 open[4];
    std::uint32_t count = 0;
    for (const glm::ivec2& step : steps)
      if (map.at(here.x + step.x, here.y + step.y) != 0) open[count++] = step;
    if (count == 0) {
      way.pop_back();
      continue;
    }
    const glm::ivec2 step = open[random.below(count)];
    map.walls[map.index(here.x + step.x / 2, here.y + step.y / 2)] = 0;
    map.walls[map.index(here.x + step.x, here.y + step.y)] = 0;
    way.push_back(here + step);
  }
  for (int z = 1; z + 1 < map.depth; ++z)
    for (int x = 1; x + 1 < map.width; ++x) {
      std::uint8_t& wall = map.walls[map.index(x, z)];
      // Walls between two passages; the posts where walls meet stay.
      if (wall != 0 && (x + z) % 2 == 1 && random.chance(loops)) wall = 0;
    }
  for (std::uint8_t& wall : map.walls)
    if (wall != 0) wall = static_cast<std::uint8_t>(1 + random.below(4));
  return map;
}

std::vector<ObjectId> wall_objects(const GridMap& map) {
  std::vector<ObjectId> objects(map.walls.size(), no_object);
  ObjectId next = 0;
  for (std::size_t i = 0; i < map.walls.size(); ++i)
    if (map.walls[i] != 0) objects[i] = next++;
  return objects;
}

Scene extrude(const GridMap& map) {
  check_grid_map(map);
  SceneBuilder builder;
  const float c = map.cell;
  const MeshId box = builder.add_mesh(make_box({0, 0, 0}, {c, map.height, c}));
  for (int z = 0; z < map.depth; ++z)
    for (int x = 0; x < map.width; ++x)
      if (map.at(x, z) != 0)
        builder.add_object(
            box, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {c * static_cast<float>(x), 0, c * static_cast<float>(z)}}, "wall");
  const float w = c * static_cast<float>(map.width), d = c * static_cast<float>(map.depth);
  const auto sheet = [&](const char* name, float y, bool up) {
    Mesh mesh{name, {{0, y, 0}, {w, y, 0}, {w, y, d}, {0, y, d}}, {{0, 2, 1}, {0, 3, 2}}, false, {}};
    if (!up) mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    builder.add_object(builder.add_mesh(std::move(mesh)), identity_affine(), name);
  };
  sheet("floor", 0.0f, true);
  sheet("ceiling", map.height, false);
  return builder.build();
}

}  // namespace sightline
