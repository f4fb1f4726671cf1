#include "sightline/scene/generate/building_parts.hpp"

namespace sightline {
namespace {

using namespace building;

constexpr float wall_bottom = static_cast<float>(-0.5 * slab), wall_top = static_cast<float>(storey - 0.5 * slab);
constexpr float sill = 0.875f, lintel = 2.25f;
constexpr float door_bottom = -0.03125f, door_top = 2.125f;  // the bottom lies below the floor's surface

WallKind wall(Layout& layout, std::string_view name, double width, float thickness, std::vector<Opening> openings) {
  const Part part = layout.part(name, make_wall(static_cast<float>(width), wall_bottom, wall_top, thickness, openings));
  return {part, std::move(openings)};
}

Opening doorway(float left, float right) { return {left, door_bottom, right, door_top}; }
Opening window(float left, float right) { return {left, sill, right, lintel}; }

// A top on four legs.
Mesh table_mesh(float x, float height, float z, float leg) {
  Mesh mesh = make_box({-x, height - 0.04f, -z}, {x, height, z});
  for (const float sx : {-1.0f, 1.0f})
    for (const float sz : {-1.0f, 1.0f}) {
      const glm::vec3 centre(sx * (x - 1.5f * leg), 0, sz * (z - 1.5f * leg));
      append(mesh, make_box(centre - glm::vec3(leg, 0, leg), centre + glm::vec3(leg, height - 0.02f, leg)));
    }
  return mesh;
}

Mesh chair_mesh() {
  Mesh mesh = table_mesh(0.22f, 0.46f, 0.22f, 0.02f);
  append(mesh, make_box({-0.2f, 0.44f, -0.23f}, {0.2f, 0.92f, -0.19f}));
  return mesh;
}

Mesh shelf_mesh() {
  Mesh mesh = make_box({-0.5f, 0, -0.16f}, {-0.47f, 2, 0.16f});
  append(mesh, make_box({0.47f, 0, -0.16f}, {0.5f, 2, 0.16f}));
  for (int i = 0; i < 6; ++i) {
    const float y = 0.05f + 0.37f * static_cast<float>(i);
    append(mesh, make_box({-0.48f, y, -0.155f}, {0.48f, y + 0.025f, 0.155f}));
  }
  return mesh;
}

Mesh bed_mesh() {
  Mesh mesh = make_box({-0.5f, 0.15f, -1}, {0.5f, 0.3f, 1});
  append(mesh, make_box({-0.48f, 0.28f, -0.95f}, {0.48f, 0.5f, 0.98f}));
  append(mesh, make_box({-0.51f, 0, -1.05f}, {0.51f, 0.95f, -0.98f}));
  append(mesh, make_box({-0.35f, 0.48f, -0.9f}, {0.35f, 0.6f, -0.5f}));
  for (const float x : {-0.46f, 0.42f}) append(mesh, make_box({x, 0, 0.9f}, {x + 0.05f, 0.2f, 0.95f}));
  return mesh;
}

Mesh sofa_mesh() {
  Mesh mesh = make_box({-0.95f, 0.08f, -0.4f}, {0.95f, 0.42f, 0.4f});
  append(mesh, make_box({-0.9f, 0.4f, -0.42f}, {0.9f, 0.8f, -0.15f}));
  append(mesh, make_box({-1.05f, 0.06f, -0.41f}, {-0.85f, 0.6f, 0.42f}));
  append(mesh, make_box({0.85f, 0.06f, -0.41f}, {1.05f, 0.6f, 0.42f}));
  return mesh;
}

Mesh plant_mesh(double detail) {
  const glm::vec2 pot[] = {{0.14f, 0}, {0.2f, 0.35f}};
  Mesh mesh = make_lathe(pot, round_section(scaled(10, detail, 3)));
  const Mesh leaf = make_ball(scaled(6, detail, 3), scaled(4, detail, 2));
  for (int i = 0; i < 7; ++i) {
    const glm::dvec2 c = circle_point(i * 0.382);
    // No two leaves are alike, so that none of their rings coincide where they cross.
    const float lean = i == 0 ? 0.0f : 0.15f + 0.005f * static_cast<float>(i);
    const glm::vec3 centre(lean * c.x, 0.72f + 0.01f * static_cast<float>(i), lean * c.y);
    append(mesh, leaf, {{0.1f, 0, 0}, {1.7f * centre.x, 0.4f, 1.7f * centre.z}, {0, 0, 0.1f}, centre});
  }
  return mesh;
}

Mesh floor_lamp_mesh(double detail) {
  const glm::vec2 stand[] = {{0.16f, 0}, {0.16f, 0.02f}, {0.015f, 0.04f}, {0.015f, 1.45f}};
  const glm::vec2 shade[] = {{0.2f, 1.4f}, {0.14f, 1.65f}};
  Mesh mesh = make_lathe(stand, round_section(scaled(10, detail, 3)));
  append(mesh, make_lathe(shade, round_section(scaled(10, detail, 3))));
  return mesh;
}

Mesh ceiling_lamp_mesh(double detail) {
  Mesh mesh;  // hangs from y = 0
  const glm::vec2 cord[] = {{0.01f, -0.32f}, {0.01f, 0}};
  const glm::vec2 shade[] = {{0.25f, -0.5f}, {0.22f, -0.42f}, {0.06f, -0.3f}};
  append(mesh, make_lathe(cord, round_section(3)));
  append(mesh, make_lathe(shade, round_section(scaled(12, detail, 3))));
  return mesh;
}

Mesh turned(double detail, std::initializer_list<glm::vec2> profile) {
  return make_lathe(std::span<const glm::vec2>(profile.begin(), profile.size()), round_section(scaled(10, detail, 3)));
}

Mesh monitor_mesh() {
  Mesh mesh = make_box({-0.27f, 0.1f, -0.02f}, {0.27f, 0.45f, 0.02f});
  append(mesh, make_box({-0.03f, 0.01f, -0.05f}, {0.03f, 0.15f, -0.015f}));
  append(mesh, make_box({-0.12f, 0, -0.1f}, {0.12f, 0.02f, 0.08f}));
  return mesh;
}

// A flight of ten steps as seen from the side, `width` across; rises along +x from the origin to the next floor.
Mesh stairs_mesh(float run, float width) {
  constexpr int steps = 10;
  std::vector<float> u, v;
  std::vector<char> filled;
  for (int i = 0; i <= steps; ++i) {
    u.push_back(run * static_cast<float>(i) / steps);
    v.push_back(i == 0 ? 0.0f : static_cast<float>(storey) * static_cast<float>(i) / steps);
  }
  v.back() -= 0.015625f;  // the last step ends below the next floor
  for (int row = 0; row < steps; ++row)
    for (int column = 0; column < steps; ++column) filled.push_back(column >= row && column <= row + 2 ? 1 : 0);
  return make_plate(u, v, filled, width);
}

Mesh tree_mesh(double detail) {
  Mesh mesh;
  append(mesh, make_cylinder(scaled(6, detail, 3)), {{0.15f, 0, 0}, {0, 4, 0}, {0, 0, 0.15f}, {0, 0, 0}});
  append(mesh, make_ball(scaled(9, detail, 3), scaled(6, detail, 2)), {{2, 0, 0}, {0, 2.2f, 0}, {0, 0, 2}, {0, 5, 0}});
  return mesh;
}

// The slab lies: the plate's y becomes -z, so that its openings are given from the room's corner.
Mesh stair_slab_mesh() {
  const float length = static_cast<float>(depth);
  const Opening hole{stair_opening.left, length - stair_opening.top, stair_opening.right,
                     length - stair_opening.bottom};
  const Mesh plate = make_wall(static_cast<float>(bay), 0, length, static_cast<float>(slab), {&hole, 1});
  Mesh mesh;
  append(mesh, plate, {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}, {0, -0.5f * static_cast<float>(slab), length}});
  return mesh;
}

}  // namespace

BuildingParts::BuildingParts(Layout& layout) {
  constexpr float inner = 0.125f, outer = 0.25f;
  const Opening door_hole = doorway(0.75f, 1.75f);
  corridor_walls = {wall(layout, "corridor wall", bay, inner, {door_hole}),
                    wall(layout, "corridor wall", bay, inner, {door_hole, {2.5f, 1, 4.25f, door_top}}),
                    wall(layout, "corridor wall", bay, inner, {{0.75f, door_bottom, 4.25f, 2.5f}})};
  facades = {wall(layout, "facade", bay, outer, {window(1, 4)}),
             wall(layout, "facade", bay, outer, {window(0.75f, 2), window(3, 4.25f)})};
  back = wall(layout, "wall", bay, inner, {});
  back_door = wall(layout, "wall", bay, inner, {doorway(2, 3)});
  partition = wall(layout, "partition", depth, inner, {});
  partition_door = wall(layout, "partition", depth, inner, {doorway(4, 5)});
  end_facade = wall(layout, "facade", depth, outer, {window(2, 4)});
  end_window = wall(layout, "facade", corridor, outer, {window(0.75f, 1.75f)});
  end_solid = wall(layout, "facade", corridor, outer, {});
  entrance = wall(layout, "facade", corridor, outer, {doorway(0.75f, 1.75f)});
  floor_slab = layout.part("slab", make_box({0, static_cast<float>(-slab), 0}, {1, 0, 1}));
  stair_slab = layout.part("slab", stair_slab_mesh());
  stairs = layout.part("stairs", stairs_mesh(stair_opening.right - stair_opening.left - 0.25f, 1.0f));
  ground = layout.part("ground", make_box({-0.5f, -1, -0.5f}, {0.5f, 0, 0.5f}));
  door = layout.part("door", make_box({0.015625f, 0.015625f, -0.03125f}, {0.984375f, 2.109375f, 0.03125f}));
  pane = layout.part("pane", make_box({0, 0, -0.0078125f}, {1, 1, 0.0078125f}));
  desk = {layout.part("desk", table_mesh(0.8f, 0.74f, 0.4f, 0.03f)), 0.74f, 0.65f, 0.25f};
  table = {layout.part("table", table_mesh(1, 0.75f, 0.5f, 0.04f)), 0.75f, 0.8f, 0.35f};
  cupboard = {layout.part("cupboard", make_box({-0.6f, 0, -0.28f}, {0.6f, 1.9f, 0.28f})), 1.9f, 0.45f, 0.15f};
  shelf = {layout.part("shelf", shelf_mesh()), 1.55f, 0.35f, 0.02f};
  bed = {layout.part("bed", bed_mesh()), 0.5f, 0.35f, 0.3f};
  sofa = {layout.part("sofa", sofa_mesh()), 0.42f, 0.6f, 0.05f};
  sideboard = {layout.part("sideboard", make_box({-0.8f, 0.06f, -0.22f}, {0.8f, 0.8f, 0.22f})), 0.8f, 0.65f, 0.1f};
  chair = layout.part("chair", chair_mesh());
  stool = layout.part("stool", [](double detail) {
    return turned(detail, {{0.05f, 0}, {0.05f, 0.4f}, {0.18f, 0.42f}, {0.18f, 0.46f}});
  });
  plant = layout.part("plant", plant_mesh);
  floor_lamp = layout.part("floor lamp", floor_lamp_mesh);
  ceiling_lamp = layout.part("ceiling lamp", ceiling_lamp_mesh);
  things = {layout.part("monitor", monitor_mesh()),
            layout.part("box", make_box({-0.12f, 0, -0.1f}, {0.12f, 0.16f, 0.1f})),
            layout.part("book", make_box({-0.1f, 0, -0.07f}, {0.1f, 0.03f, 0.07f})),
            layout.part("books", make_box({-0.15f, 0, -0.1f}, {0.15f, 0.24f, 0.08f})),
            layout.part("cup", [](double detail) { return turned(detail, {{0.035f, 0}, {0.04f, 0.09f}}); }),
            layout.part("vase",
                        [](double detail) {
                          return turned(detail, {{0.05f, 0}, {0.09f, 0.12f}, {0.03f, 0.24f}, {0.05f, 0.28f}});
                        }),
            layout.part("ball", [](double detail) {
              Mesh mesh;
              append(mesh, make_ball(scaled(10, detail, 3), scaled(6, detail, 2)),
                     {{0.08f, 0, 0}, {0, 0.08f, 0}, {0, 0, 0.08f}, {0, 0.08f, 0}});
              return mesh;
            })};
  tree = layout.part("tree", tree_mesh);
}

}  // namespace sightline
