#include "sightline/scene/generate/raster_scenes.hpp"

#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/generate/shapes.hpp"

namespace sightline {
namespace {

/// A ball with bumps: a few waves along each axis, so that neighbouring triangles differ in depth and normal.
Mesh bumpy_ball(int sides, int rings, double phase) {
  Mesh mesh = make_ball(sides, rings);
  mesh.name = "bumpy ball";
  for (glm::vec3& p : mesh.positions) {
    const glm::dvec3 at(p);
    const double wave = circle_point(0.9 * at.x + phase).y * circle_point(1.1 * at.y + 0.3).x +
                        0.5 * circle_point(2.3 * at.z + phase).y * circle_point(1.9 * at.x).x;
    p = glm::vec3(at * (1.0 + 0.06 * wave));
  }
  return mesh;
}

Affine placed(const glm::dvec3& place, double size) {
  const auto s = static_cast<float>(size);
  return {{s, 0, 0}, {0, s, 0}, {0, 0, s}, glm::vec3(place)};
}

Mesh floor_grid(int n, float half) {
  Mesh mesh;
  mesh.name = "floor";
  const auto at = [&](int i) { return half * (2.0f * static_cast<float>(i) / static_cast<float>(n) - 1.0f); };
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) mesh.positions.emplace_back(at(i), 0.0f, at(j));
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto a = static_cast<std::uint32_t>(j * (n + 1) + i), b = a + static_cast<std::uint32_t>(n + 1);
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  return mesh;
}

}  // namespace

SceneAndView spheres_and_floor() {
  SceneBuilder builder;
  Random random(64);
  for (int k = 0; k < 64; ++k) {
    const MeshId mesh = builder.add_mesh(bumpy_ball(88, 88, 0.11 * k));
    const glm::dvec3 cell(k % 8, k / 8 % 4, k / 32);
    const glm::dvec3 jitter(random.range(-0.3, 0.3), random.range(-0.2, 0.2), random.range(-0.5, 0.5));
    builder.add_object(mesh, placed(glm::dvec3(2.4, 2.3, -4.0) * (cell - glm::dvec3(3.5, 1.5, 0)) + jitter, 1.2));
  }
  const MeshId floor = builder.add_mesh(floor_grid(70, 30.0f));
  builder.add_object(floor, placed({0, -5.2, -5}, 1.0));
  View view = look_along({0, 1.2, 10.4}, {0, -0.12, -1});
  view.far = 60;
  return {builder.build(), view};
}

SceneAndView full_screen_layers(int count) {
  SceneBuilder builder;
  const MeshId quad = builder.add_mesh(
      {"layer", {{-40, -40, 0}, {40, -40, 0}, {40, 40, 0}, {-40, 40, 0}}, {{0, 1, 2}, {0, 2, 3}}, false, {}});
  for (int i = 0; i < count; ++i) {
    // Tilted a little, each the other way, without crossing its neighbours.
    const float tilt = i % 2 == 0 ? 2e-4f : -2e-4f;
    builder.add_object(quad, {{1, 0, tilt}, {0, 1, -tilt}, {0, 0, 1}, {0, 0, -20.0f + 0.05f * static_cast<float>(i)}});
  }
  View view = look_along({0, 0, 0}, {0, 0, -1});
  view.far = 100;
  return {builder.build(), view};
}

SceneAndView instanced_spheres(int n) {
  SceneBuilder builder;
  const MeshId mesh = builder.add_mesh(bumpy_ball(77, 78, 0.4));
  Random random(540);
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const glm::dvec3 jitter(random.range(-0.4, 0.4), random.range(-0.4, 0.4), random.range(-0.4, 0.4));
        const glm::dvec3 place = 2.5 * (glm::dvec3(x, y, z) - 0.5 * (n - 1)) + jitter;
        builder.add_object(mesh, placed(place, random.range(0.8, 1.2)));
      }
  View view = look_along(glm::dvec3(1.9, 1.3, 2.3) * static_cast<double>(n), {-1.9, -1.3, -2.3});
  view.near = 0.5;
  view.far = 12.0 * n;
  return {builder.build(), view};
}

}  // namespace sightline
