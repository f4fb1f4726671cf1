// Objects without order, for tests: triangles, slivers, boxes, balls and clouds of triangles of all sizes, turned,
// stretched and mirrored, through each other; one in eight lets light through.
#include <cmath>

#include "sightline/scene/generate/kinds.hpp"
#include "sightline/scene/generate/layout.hpp"

namespace sightline {
namespace {

glm::vec3 point_in_unit_cube(Random& random) {
  const double x = random.range(-1, 1), y = random.range(-1, 1), z = random.range(-1, 1);
  return {x, y, z};
}

// Loose triangles in the cube from -1 to 1; every third one a sliver up to 2^20 times as long as wide.
Mesh triangle_cloud(Random& random, std::uint32_t count) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < count; ++i) {
    const glm::vec3 a = point_in_unit_cube(random), b = point_in_unit_cube(random);
    glm::vec3 c = point_in_unit_cube(random);
    if (i % 3 == 1) c = a + (b - a) * 0.5f + (c - a) * static_cast<float>(random.power_of_two_range(-20, -4));
    mesh.triangles.push_back(glm::uvec3(3 * i, 3 * i + 1, 3 * i + 2));
    mesh.positions.insert(mesh.positions.end(), {a, b, c});
  }
  return mesh;
}

std::vector<Part> make_parts(Layout& layout, Random& random) {
  std::vector<Part> parts;
  for (int i = 0; i < 6; ++i) parts.push_back(layout.part("triangle", triangle_cloud(random, 1)));
  parts.push_back(layout.part("pair", triangle_cloud(random, 2)));
  parts.push_back(layout.part("cloud", triangle_cloud(random, 24)));
  for (int i = 0; i < 3; ++i) parts.push_back(layout.part("box", make_box(glm::vec3(-1), glm::vec3(1))));
  for (int i = 0; i < 2; ++i)
    parts.push_back(
        layout.part("ball", [](double detail) { return make_ball(scaled(12, detail, 3), scaled(6, detail, 2)); }));
  parts.push_back(layout.part("spike", [](double detail) {
    const glm::vec2 profile[] = {{1, -1}, {0, 1}};
    return make_lathe(profile, round_section(scaled(9, detail, 3)));
  }));
  return parts;
}

// Any rotation, then a stretch of up to eight along each of its axes, mirrored half the time.
Affine any_placement(Random& random, double spread) {
  const glm::dvec3 a = random.direction();
  glm::dvec3 b = random.direction();
  b -= a * glm::dot(a, b);
  const double length = std::sqrt(glm::dot(b, b));
  b = length > 1e-6 ? b / length : glm::dvec3(a.y, -a.x, 0);
  const glm::dvec3 c = glm::cross(a, b) * (random.chance(0.5) ? 1.0 : -1.0);
  const double size = random.power_of_two_range(-7, 3);
  const double sa = size * random.power_of_two_range(-3, 0), sb = size * random.power_of_two_range(-3, 0);
  const glm::dvec3 centre = glm::dvec3(point_in_unit_cube(random)) * spread;
  return {glm::vec3(a * sa), glm::vec3(b * sb), glm::vec3(c * size), glm::vec3(centre)};
}

}  // namespace

Scene generate_soup(const GenerateConfig& config) {
  Layout layout(config);
  Random shapes(config.seed, 1), random(config.seed, 2);
  const std::vector<Part> parts = make_parts(layout, shapes);
  // The mean size of an object stays a fixed share of the space around it.
  double spread = 8.0;
  while (spread * spread * spread < 8.0 * config.objects) spread *= 1.25;
  while (layout.left() > 0) {
    const Part part = parts[random.below(static_cast<std::uint32_t>(parts.size()))];
    const Affine transform = any_placement(random, spread);
    layout.place(part, transform, !random.chance(0.125));
  }
  return layout.build();
}

}  // namespace sightline
