#include "cost_model.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <vector>

#include "sightline/registry.hpp"

namespace sightline::cli {
namespace {

constexpr int runs = 5;

template <class F>
double median_ms(F&& work) {
  std::vector<double> times;
  for (int i = 0; i < runs; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    times.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  std::sort(times.begin(), times.end());
  return times[runs / 2];
}

View front_view() {
  View view;  // at the origin, looks along -z
  view.width = 640;
  view.height = 360;
  return view;
}

/// What drawing the scene adds to drawing nothing, for each unit that `count` names.
template <class F>
double unit_cost(const Scene& scene, F&& count) {
  const IndexedScene indexed = index_scene(scene);
  const auto renderer = make_renderer("zbuffer", indexed);
  const VisibleSet all = VisibleSet::all(scene.objects().size()), none(scene.objects().size());
  const View view = front_view();
  Frame frame;
  Counters counters;
  renderer->draw(view, all, frame, counters);  // once, to warm up and to count
  const double units = static_cast<double>(count(counters));
  const double with = median_ms([&] { renderer->draw(view, all, frame, counters); });
  const double without = median_ms([&] { renderer->draw(view, none, frame, counters); });
  return units > 0 ? std::max(0.0, with - without) / units : 0.0;
}

/// Triangles far smaller than a pixel, in view but off the pixel centres: all work but filling.
Scene tiny_triangles() {
  constexpr std::uint32_t across = 150;
  Mesh mesh;
  for (std::uint32_t j = 0; j < across; ++j)
    for (std::uint32_t i = 0; i < across; ++i) {
      const glm::vec3 p((static_cast<float>(i) / across - 0.5f) * 8, (static_cast<float>(j) / across - 0.5f) * 4, -10);
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const glm::vec3& d : {glm::vec3(0), glm::vec3(1e-5f, 0, 0), glm::vec3(0, 1e-5f, 0)})
        mesh.positions.push_back(p + d);
      mesh.triangles.emplace_back(first, first + 1, first + 2);
    }
  SceneBuilder builder;
  builder.add_object(builder.add_mesh(std::move(mesh)), identity_affine());
  return builder.build();
}

/// Walls that fill the view, the farthest first, so that every pixel of each is tested and written.
Scene full_walls() {
  Mesh mesh;
  for (int i = 0; i < 12; ++i) {
    const float z = -40.0f + static_cast<float>(i);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const glm::vec2& c : {glm::vec2(-90, -90), glm::vec2(90, -90), glm::vec2(90, 90), glm::vec2(-90, 90)})
      mesh.positions.emplace_back(c.x, c.y, z);
    mesh.triangles.emplace_back(first, first + 1, first + 2);
    mesh.triangles.emplace_back(first, first + 2, first + 3);
  }
  SceneBuilder builder;
  builder.add_object(builder.add_mesh(std::move(mesh)), identity_affine());
  return builder.build();
}

double copy_cost() {
  std::vector<unsigned char> from(std::size_t{32} << 20, 1), to(from.size());
  std::memcpy(to.data(), from.data(), from.size());
  return median_ms([&] { std::memcpy(to.data(), from.data(), from.size()); }) / static_cast<double>(from.size());
}

}  // namespace

UnitCosts measure_unit_costs() {
  UnitCosts units;
  units.per_triangle = unit_cost(tiny_triangles(), [](const Counters& c) { return c.triangles_in; });
  units.per_pixel = unit_cost(full_walls(), [](const Counters& c) { return c.pixels_tested; });
  units.per_byte = copy_cost();
  return units;
}

StageCosts stage_costs(const FrameWork& work, const UnitCosts& units) {
  StageCosts costs;
  costs.application_ms = work.application_ms;
  costs.geometry_ms = work.triangles * units.per_triangle;
  costs.bus_ms = work.bytes * units.per_byte;
  if (work.pixels) costs.fill_ms = *work.pixels * units.per_pixel;
  costs.limiting = "application";
  costs.limiting_ms = costs.application_ms;
  const auto slower = [&](std::string_view name, double ms) {
    if (ms <= costs.limiting_ms) return;
    costs.limiting = name;
    costs.limiting_ms = ms;
  };
  slower("geometry", costs.geometry_ms);
  slower("fill", costs.fill_ms.value_or(0.0));
  slower("bus", costs.bus_ms);
  return costs;
}

}  // namespace sightline::cli
