#include "sightline/scene/generate/plant_parts.hpp"

#include <cmath>

namespace sightline {
namespace {

// Maps +y to +x, for lathed things that lie.
const Affine lying{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}, {0, 0, 0}};

Affine scaled_by(float x, float y, float z, const glm::vec3& move = glm::vec3(0)) {
  return {{x, 0, 0}, {0, y, 0}, {0, 0, z}, move};
}

// The section is a grid of filled cells across (z, y), drawn out along x from 0 to 1.
Mesh profile_bar(std::span<const float> across, std::span<const float> up, std::span<const char> filled) {
  Mesh mesh;  // the plate's x becomes -z, its z becomes x
  append(mesh, make_plate(across, up, filled, 1), {{0, 0, -1}, {0, 1, 0}, {1, 0, 0}, {0.5f, 0, 0}});
  return mesh;
}

Mesh girder_mesh() {
  const float across[] = {-0.15f, -0.01f, 0.01f, 0.15f}, up[] = {-0.15f, -0.13f, 0.13f, 0.15f};
  const char filled[] = {1, 1, 1, 0, 1, 0, 1, 1, 1};
  return profile_bar(across, up, filled);
}

Mesh tray_mesh() {
  const float across[] = {-0.2f, -0.19f, 0.19f, 0.2f}, up[] = {0, 0.01f, 0.1f};
  const char filled[] = {1, 1, 1, 1, 0, 1};
  return profile_bar(across, up, filled);
}

Mesh turned(double detail, int sides, std::initializer_list<glm::vec2> profile) {
  return make_lathe(std::span<const glm::vec2>(profile.begin(), profile.size()),
                    round_section(scaled(sides, detail, 3)));
}

Mesh valve_mesh(double detail) {
  Mesh mesh;
  append(mesh,
         turned(detail, 12,
                {{1.6f, -1.6f},
                 {1.6f, -1.3f},
                 {0.9f, -1.2f},
                 {1.3f, -0.5f},
                 {1.3f, 0.5f},
                 {0.9f, 1.2f},
                 {1.6f, 1.3f},
                 {1.6f, 1.6f}}),
         lying);
  append(mesh, turned(detail, 8, {{0.7f, 1}, {0.7f, 1.6f}, {0.2f, 1.7f}, {0.2f, 3.4f}}));
  const int rim = scaled(12, detail, 4);
  std::vector<glm::vec3> wheel;  // three quarters of a ring: a pipe cannot close on itself
  for (int i = 0; i <= rim; ++i) {
    const glm::dvec2 p = circle_point(0.92 * i / rim);
    wheel.emplace_back(1.4 * p.x, 3.3, 1.4 * p.y);
  }
  append(mesh, make_pipe(wheel, 0.13f, scaled(5, detail, 3)));
  append(mesh, make_box({-1.35f, 3.2f, -0.1f}, {1.35f, 3.35f, 0.1f}));
  return mesh;
}

// Legs of a pipe along the axes, with rounded corners.
Mesh bend_mesh(double detail, std::initializer_list<glm::vec3> legs) {
  constexpr float bend = 0.3f;
  const int cuts = scaled(3, detail, 1);
  std::vector<glm::vec3> corners{glm::vec3(0)}, points{glm::vec3(0)};
  for (const glm::vec3& leg : legs) corners.push_back(corners.back() + leg);
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const glm::vec3 in = glm::normalize(corners[i] - corners[i - 1]), out = glm::normalize(corners[i + 1] - corners[i]);
    const glm::vec3 centre = corners[i] - in * bend + out * bend;
    for (int k = 0; k <= cuts; ++k) {
      const glm::vec2 c(circle_point(0.25 * k / cuts));
      points.push_back(centre - out * (bend * c.x) + in * (bend * c.y));
    }
  }
  points.push_back(corners.back());
  return make_pipe(points, 0.1f, scaled(8, detail, 3));
}

Mesh tank_mesh(double detail) {
  return turned(detail, 24, {{1, 0}, {1, 0.88f}, {1.01f, 0.88f}, {1.01f, 0.9f}, {0.8f, 0.95f}, {0.4f, 0.99f}, {0, 1}});
}

Mesh sphere_mesh(double detail) {
  Mesh mesh;
  append(mesh, make_ball(scaled(20, detail, 4), scaled(12, detail, 2)), scaled_by(1, 1, 1, {0, 1.4f, 0}));
  for (int i = 0; i < 6; ++i) {
    const glm::vec2 c(circle_point(i / 6.0));
    append(mesh, make_cylinder(scaled(6, detail, 3)), scaled_by(0.06f, 1.4f, 0.06f, {0.95f * c.x, 0, 0.95f * c.y}));
  }
  return mesh;
}

Mesh vessel_mesh(double detail) {
  Mesh mesh;
  const Mesh body =
      turned(detail, 16,
             {{0, -2.5f}, {0.5f, -2.43f}, {0.85f, -2.27f}, {1, -2}, {1, 2}, {0.85f, 2.27f}, {0.5f, 2.43f}, {0, 2.5f}});
  append(mesh, body, {lying[0], lying[1], lying[2], {0, 1.5f, 0}});
  for (const float x : {-1.5f, 1.3f}) append(mesh, make_box({x, 0, -0.85f}, {x + 0.2f, 1, 0.85f}));
  append(mesh, make_cylinder(scaled(8, detail, 3)), scaled_by(0.2f, 0.5f, 0.2f, {0.5f, 2.4f, 0}));
  return mesh;
}

Mesh reactor_mesh(double detail) {
  Mesh mesh = turned(detail, 18, {{1.05f, 0}, {1.05f, 0.8f}, {1, 0.8f}, {1, 5}, {0.85f, 5.5f}, {0.5f, 5.85f}, {0, 6}});
  append(mesh, make_cylinder(scaled(8, detail, 3)), scaled_by(0.15f, 0.6f, 0.15f, {0.3f, 5.7f, 0.2f}));
  for (const float y : {2.0f, 4.2f}) {
    Mesh ring = turned(detail, 18, {{1.12f, -0.1f}, {1.12f, 0.1f}});
    append(mesh, ring, scaled_by(1, 1, 1, {0, y, 0}));
  }
  return mesh;
}

Mesh ladder_mesh() {
  Mesh mesh;
  for (const float x : {-0.25f, 0.22f}) append(mesh, make_box({x, 0, 0.15f}, {x + 0.03f, 3.3f, 0.2f}));
  for (int i = 0; i < 10; ++i) {
    const float y = 0.3f * static_cast<float>(i + 1);
    append(mesh, make_box({-0.23f, y, 0.165f}, {0.23f, y + 0.02f, 0.185f}));
  }
  return mesh;
}

// Bearing bars, and cross bars within them.
Mesh grating_mesh() {
  Mesh mesh;
  constexpr int bars = 24;
  for (int i = 0; i < bars; ++i) {
    const float z = static_cast<float>(i) / bars;
    append(mesh, make_box({0, -0.04f, z}, {1, 0, z + 0.008f}));
  }
  for (const float x : {0.1f, 0.5f, 0.9f}) append(mesh, make_box({x, -0.03f, 0.001f}, {x + 0.01f, -0.01f, 0.999f}));
  return mesh;
}

Mesh handrail_mesh() {
  Mesh mesh;
  for (const float x : {0.0f, 1.47f, 2.94f}) append(mesh, make_box({x, 0, 0}, {x + 0.05f, 1.1f, 0.05f}));
  for (const float y : {0.5f, 1.06f}) append(mesh, make_box({-0.01f, y, 0.01f}, {3.01f, y + 0.04f, 0.04f}));
  append(mesh, make_box({0.01f, 0.005f, 0.02f}, {2.98f, 0.12f, 0.03f}));
  return mesh;
}

Mesh pump_mesh(double detail) {
  Mesh mesh = make_box({-0.9f, 0, -0.4f}, {0.9f, 0.25f, 0.4f});
  const Mesh motor = turned(detail, 12, {{0.28f, 0}, {0.28f, 0.7f}, {0.08f, 0.72f}, {0.08f, 1.1f}});
  append(mesh, motor, {lying[0], lying[1], lying[2], {-0.8f, 0.55f, 0}});
  append(mesh, turned(detail, 12, {{0.2f, 0}, {0.36f, 0.1f}, {0.36f, 0.4f}, {0.12f, 0.45f}, {0.12f, 0.55f}}),
         {lying[0], lying[1], lying[2], {0.25f, 0.55f, 0}});
  append(mesh, make_cylinder(scaled(8, detail, 3)), scaled_by(0.1f, 0.6f, 0.1f, {0.5f, 0.7f, 0}));
  return mesh;
}

Mesh lamp_mesh(double detail) {
  Mesh mesh = turned(detail, 6, {{0.06f, 0}, {0.04f, 4}});
  append(mesh, make_box({-0.12f, 3.9f, -0.05f}, {0.12f, 4.05f, 0.6f}));
  return mesh;
}

}  // namespace

PlantParts::PlantParts(Layout& layout) {
  ground = layout.part("ground", make_box({-0.5f, -1, -0.5f}, {0.5f, 0, 0.5f}));
  girder = layout.part("girder", girder_mesh());
  Mesh upright;
  append(upright, girder_mesh(), {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {0, 0, 0}});
  column = layout.part("column", std::move(upright));
  pipe = layout.part("pipe", [](double detail) {
    Mesh mesh;
    append(mesh, make_cylinder(scaled(10, detail, 3)), lying);
    return mesh;
  });
  flange = layout.part("flange", [](double detail) {
    Mesh mesh;
    append(mesh, turned(detail, 12, {{1.1f, -0.5f}, {1.7f, -0.4f}, {1.7f, 0.4f}, {1.1f, 0.5f}}), lying);
    return mesh;
  });
  valve = layout.part("valve", valve_mesh);
  bends = {layout.part("bend", [](double d) { return bend_mesh(d, {{1.2f, 0, 0}, {0, 1.5f, 0}}); }),
           layout.part("bend", [](double d) { return bend_mesh(d, {{0, 1.4f, 0}, {0, 0, 1.2f}, {0, 1, 0}}); }),
           layout.part("bend", [](double d) { return bend_mesh(d, {{1, 0, 0}, {0, 0, 1.3f}, {0, -1, 0}, {1, 0, 0}}); }),
           layout.part("loop", [](double d) {
             return bend_mesh(d, {{1, 0, 0}, {0, 1.1f, 0}, {1.2f, 0, 0}, {0, -1.1f, 0}, {1, 0, 0}});
           })};
  tank = layout.part("tank", tank_mesh);
  sphere = layout.part("sphere", sphere_mesh);
  vessel = layout.part("vessel", vessel_mesh);
  reactor = layout.part("reactor", reactor_mesh);
  ladder = layout.part("ladder", ladder_mesh());
  platform = layout.part("platform", make_box({0, -0.08f, 0}, {1, 0, 1}));
  grating = layout.part("grating", grating_mesh());
  handrail = layout.part("handrail", handrail_mesh());
  pump = layout.part("pump", pump_mesh);
  lamp = layout.part("lamp", lamp_mesh);
  cabinet = layout.part("cabinet", make_box({-0.5f, 0, -0.3f}, {0.5f, 2, 0.3f}));
  tray = layout.part("tray", tray_mesh());
  dike = layout.part("dike", make_box({0, -0.1f, -0.15f}, {1, 1, 0.15f}));
}

}  // namespace sightline
