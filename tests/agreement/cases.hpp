// Scenes and views that every algorithm must survive: generated ones of all kinds, degenerate ones, hard cameras.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "sightline/scene/generate/generate.hpp"
#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/load/load.hpp"
#include "sightline/scene/scene.hpp"
#include "sightline/scene/view.hpp"

namespace sightline::cases {

struct Case {
  std::string name;
  Scene scene;
};

inline glm::dvec3 point_in(const Aabb& box, Random& random) {
  return {random.range(box.lo.x, box.hi.x), random.range(box.lo.y, box.hi.y), random.range(box.lo.z, box.hi.z)};
}

inline Mesh quad(const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v) {
  return {"quad", {corner, corner + u, corner + u + v, corner + v}, {{0, 1, 2}, {0, 2, 3}}, false, {}};
}

inline Mesh cube(float half = 0.5f) {
  Mesh mesh;
  mesh.name = "cube";
  for (int i = 0; i < 8; ++i)
    mesh.positions.emplace_back((i & 1) != 0 ? half : -half, (i & 2) != 0 ? half : -half, (i & 4) != 0 ? half : -half);
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

inline Affine at(const glm::vec3& place) { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, place}; }

/// Turned about the upright axis, radians.
inline Affine turned(double angle, const glm::vec3& place) {
  const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  return {{c, 0, -s}, {0, 1, 0}, {s, 0, c}, place};
}

/// A wall of two halves with a gap between them, and small cubes behind: the gap is what cullers like to lose.
inline Scene gap_scene(float gap) {
  SceneBuilder builder;
  const MeshId half = builder.add_mesh(quad({0, -5, 0}, {5, 0, 0}, {0, 10, 0}));
  const MeshId box = builder.add_mesh(cube(0.2f));
  builder.add_object(half, at({gap / 2, 0, 0}), "right");
  builder.add_object(half, at({-5 - gap / 2, 0, 0}), "left");
  for (int i = -10; i <= 10; ++i)
    for (int j = -6; j <= 6; ++j)
      builder.add_object(box, at({0.45f * static_cast<float>(i), 0.5f * static_cast<float>(j), -3}));
  return builder.build();
}

/// Cubes and large quads at random places, for tests that move them.
inline Scene moving_boxes(std::uint64_t seed) {
  SceneBuilder builder;
  const MeshId box = builder.add_mesh(cube(2.0f)), wall = builder.add_mesh(quad({-8, -8, 0}, {16, 0, 0}, {0, 16, 0}));
  Random random(seed);
  for (int i = 0; i < 150; ++i)
    builder.add_object(i % 5 == 0 ? wall : box,
                       at({random.range(-30, 30), random.range(-30, 30), random.range(-30, 30)}));
  return builder.build();
}

/// Zero-area triangles, duplicated and coplanar faces, inverted and squashed instances, an empty mesh, glass.
inline Scene degenerate_scene() {
  SceneBuilder builder;
  Mesh broken = cube();
  broken.triangles.push_back({0, 0, 1});
  broken.triangles.push_back({0, 1, 0});
  broken.triangles.push_back({0, 2, 1});
  const MeshId odd = builder.add_mesh(broken), box = builder.add_mesh(cube());
  const MeshId empty = builder.add_mesh({"empty", {}, {}, false, {}});
  const MeshId wall = builder.add_mesh(quad({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}));
  builder.add_object(odd, at({0, 0, 0}));
  builder.add_object(empty, at({1, 0, 0}));
  builder.add_object(box, {{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {2, 0, 0}}, "mirrored");
  builder.add_object(box, {{3, 0, 0}, {0, 0, 0}, {0, 0, 1}, {0, 1, 0}}, "squashed");
  builder.add_object(box, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 2, 0}}, "point");
  builder.add_object(wall, at({0, 0, -2}), "wall");
  builder.add_object(wall, at({0, 0, -2}), "same wall again");
  builder.add_object(wall, at({0, 0, 2.5f}), "glass", {}, false);
  builder.add_object(box, at({0, 0, 4}), "behind the glass");
  for (int i = 0; i < 40; ++i) builder.add_object(box, at({-8.0f + 0.4f * static_cast<float>(i), -1, -4}));
  return builder.build();
}

/// A bumpy sheet of n x n squares; every third triangle turned around if `mixed`.
inline Mesh sheet(std::uint32_t n, float height, bool mixed) {
  Mesh mesh;
  mesh.name = "sheet";
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i)
      mesh.positions.emplace_back(2.0f * static_cast<float>(i) / static_cast<float>(n) - 1,
                                  2.0f * static_cast<float>(j) / static_cast<float>(n) - 1,
                                  (i + 2 * j) % 3 == 0 ? height : -height);
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i, b = a + n + 1;
      mesh.triangles.push_back({a, a + 1, b + 1});
      mesh.triangles.push_back({a, b + 1, b});
    }
  for (std::size_t t = 0; mixed && t < mesh.triangles.size(); t += 3)
    std::swap(mesh.triangles[t].x, mesh.triangles[t].y);
  return mesh;
}

/// What float arithmetic likes least: occluders that are sheared, squashed almost flat, mirrored, far from their own
/// origin or all far from the world's; sheets that fold, that turn their triangles either way, or that share an edge by
/// four; and small cubes before, in and behind them.
inline Scene awkward_scene(std::uint64_t seed, double far) {
  Random random(seed);
  SceneBuilder builder;
  Mesh fan;
  fan.positions = {{0, -1, 0}, {0, 1, 0}, {1, 0, 0}, {-1, 0, 0.1f}, {0.1f, 0, 1}, {0, 0.2f, -1}};
  fan.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {0, 1, 5}};
  const Mesh kinds[] = {sheet(30, 0.01f, false), sheet(6, 0.7f, false), sheet(9, 0.05f, true), fan, cube(1)};
  const MeshId small = builder.add_mesh(cube(1));
  const glm::dvec3 origin = far * random.direction();
  for (int i = 0; i < 8; ++i) {
    glm::dmat3 linear = glm::mat3_cast(glm::angleAxis(random.range(0, 6), random.direction())) * random.range(0.3, 3);
    if (i % 2 == 0)  // squash
      linear = linear * glm::dmat3(1, 0, 0, 0, 1, 0, 0, 0, random.power_of_two_range(-22, -5)) *
               glm::mat3_cast(glm::angleAxis(random.range(0, 6), random.direction()));
    if (i % 3 == 0) linear = linear * glm::dmat3(1, 0, 0, random.range(-3, 3), 1, 0, 0, 0, i % 2 == 0 ? 1 : -1);
    glm::dvec3 place = origin + 2.0 * random.direction();
    Mesh mesh = kinds[random.below(5)];
    const glm::dvec3 own = i % 4 == 1 ? 200.0 * random.direction() : glm::dvec3(0);
    for (glm::vec3& p : mesh.positions) p = glm::vec3(glm::dvec3(p) + own);
    place -= linear * own;
    builder.add_object(builder.add_mesh(mesh), {linear[0], linear[1], linear[2], place});
    for (int k = 0; k < 40; ++k) {
      const float size = static_cast<float>(random.power_of_two_range(-10, -4));
      const glm::dvec3 at = place + linear * (own + glm::dvec3(random.range(-1, 1), random.range(-1, 1), 0)) +
                            random.power_of_two_range(-12, 0) * random.direction();
      builder.add_object(small, {{size, 0, 0}, {0, size, 0}, {0, 0, size}, at});
    }
  }
  return builder.build();
}

inline std::vector<Case> generated() {
  std::vector<Case> all;
  for (const Generator& generator : generators()) {
    GenerateConfig config;
    config.objects = 600;
    config.seed = 7;
    all.push_back({std::string(generator.name), generator.make(config)});
  }
  all.push_back({"degenerate", degenerate_scene()});
  for (const std::uint64_t seed : {1, 2, 3}) {
    all.push_back({"awkward " + std::to_string(seed), awkward_scene(seed, 0)});
    all.push_back({"awkward and far " + std::to_string(seed), awkward_scene(seed, 5000)});
  }
  for (const float gap : {0.0f, 1e-4f, 0.003f, 0.02f, 0.1f})
    all.push_back({"gap " + std::to_string(gap), gap_scene(gap)});
  return all;
}

/// Cameras anywhere: inside objects, at surfaces, looking along axes, tiny and odd viewports, wide and narrow lenses,
/// infinite far planes, orthographic views.
inline std::vector<View> hard_views(const Scene& scene, int count, std::uint64_t seed, int width = 160) {
  Random random(seed);
  std::vector<View> views;
  const Aabb& bounds = scene.bounds();
  const double size = std::max(1e-3, static_cast<double>(glm::length(bounds.extent())));
  for (int i = 0; i < count; ++i) {
    glm::dvec3 eye = point_in(bounds, random);
    const Object& object = scene.objects()[random.below(static_cast<std::uint32_t>(scene.objects().size()))];
    if (i % 4 == 1 && !object.bounds.empty()) eye = point_in(object.bounds, random);
    if (i % 4 == 2 && !object.bounds.empty())
      eye = glm::dvec3(object.bounds.corner(i / 4 % 8)) + 0.02 * size * random.direction();
    if (i % 8 == 3) eye = glm::dvec3(bounds.centre()) + size * random.direction();
    glm::dvec3 look = i % 8 == 3 ? glm::dvec3(bounds.centre()) - eye : random.direction();
    if (i % 16 == 5) look = {0, 0, -1};
    if (i % 16 == 9) look = {0, -1, 0};
    View view = look_along(eye, look);
    constexpr int odd[][2] = {{1, 1}, {3, 1}, {1, 7}, {37, 101}, {255, 3}};
    view.width = width;
    view.height = width * 9 / 16;
    if (i % 8 == 6) {
      view.width = odd[i / 8 % 5][0];
      view.height = odd[i / 8 % 5][1];
    }
    view.fov_y = i % 8 == 7 ? random.range(0.02, 3.0) : random.range(0.5, 1.5);
    view.near = i % 3 == 0 ? 1e-3 * size : 1e-5 * size;
    view.near = std::max(view.near, 2e-6 * glm::length(view.eye));  // where a float still tells eye and plane apart
    view.far = i % 5 == 4 ? std::numeric_limits<double>::infinity() : 3 * size;
    if (i % 6 == 5) {
      view.projection = Projection::orthographic;
      view.span_y = random.range(0.05, 1.0) * size;
      view.far = 3 * size;
    }
    views.push_back(view);
  }
  return views;
}

/// The folder of real scenes beside the checkout; empty if there is none.
inline std::vector<std::filesystem::path> real_scenes() {
  std::vector<std::filesystem::path> files;
  const std::filesystem::path folder = std::filesystem::path(SIGHTLINE_SOURCE_DIR) / ".." / "shared" / "scenes";
  if (!std::filesystem::is_directory(folder)) return files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".glb") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace sightline::cases
