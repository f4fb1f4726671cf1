#include "sightline/scene/generate/city_parts.hpp"

namespace sightline {
namespace {

// A square building by its profile; widths are half widths.
Mesh square_building(std::initializer_list<glm::vec2> profile) {
  return make_lathe(std::span<const glm::vec2>(profile.begin(), profile.size()), square_section());
}

Mesh gabled_house(float eaves, float overhang) {
  Mesh mesh = make_box({-0.5f, 0, -0.5f}, {0.5f, eaves, 0.5f});
  const float base = eaves - 0.0078125f;  // a little below the walls' top, so that no faces coincide
  append(mesh, make_gable(), {{1 + overhang, 0, 0}, {0, 1 - base, 0}, {0, 0, 1 + overhang}, {0, base, 0}});
  return mesh;
}

Mesh hipped_house() {
  const glm::vec2 body[] = {{0.5f, 0}, {0.5f, 0.7f}};
  const glm::vec2 roof[] = {{0.53f, 0.69f}, {0.53f, 0.71f}, {0.1f, 1}};
  Mesh mesh = make_lathe(body, square_section());
  append(mesh, make_lathe(roof, square_section()));
  return mesh;
}

// Stands on the ground; the crown is `squash` times as high as wide.
Mesh tree(double detail, float height, float width, float squash) {
  Mesh mesh;
  const float crown = 0.5f * width * squash;
  append(mesh, make_cylinder(scaled(6, detail, 3)),
         {{0.04f * width, 0, 0}, {0, height - crown, 0}, {0, 0, 0.04f * width}, {0, 0, 0}});
  append(mesh, make_ball(scaled(9, detail, 3), scaled(5, detail, 2)),
         {{0.5f * width, 0, 0}, {0, crown, 0}, {0, 0, 0.5f * width}, {0, height - crown, 0}});
  return mesh;
}

Mesh lamp(double detail) {
  const glm::vec2 pole[] = {{0.15f, 0}, {0.15f, 0.4f}, {0.06f, 0.5f}, {0.05f, 6}};
  Mesh mesh = make_lathe(pole, round_section(scaled(8, detail, 3)));
  append(mesh, make_box({-0.04f, 5.9f, -0.1f}, {0.04f, 5.97f, 1.8f}));
  append(mesh, make_box({-0.15f, 5.8f, 1.2f}, {0.15f, 5.93f, 1.9f}));
  return mesh;
}

// Along x. The cabin tapers upwards.
Mesh car(double detail, float length, float cabin_low, float cabin_high, float height) {
  const float half = 0.5f * length;
  Mesh mesh = make_box({-half, 0.3f, -0.85f}, {half, 0.9f, 0.85f});
  const glm::vec2 profile[] = {{1, 0}, {0.85f, 1}};
  append(mesh, make_lathe(profile, square_section()),
         {{0.5f * (cabin_high - cabin_low), 0, 0},
          {0, height - 0.85f, 0},
          {0, 0, 0.8f},
          {0.5f * (cabin_high + cabin_low), 0.85f, 0}});
  const Mesh wheel = make_cylinder(scaled(10, detail, 3));
  for (const float x : {-0.3f * length, 0.3f * length})
    for (const float z : {-0.8f, 0.8f})
      append(mesh, wheel, {{0.32f, 0, 0}, {0, 0, 0.22f}, {0, -0.32f, 0}, {x, 0.33f, z - 0.11f}});
  return mesh;
}

Mesh bench() {
  Mesh mesh = make_box({-0.9f, 0.4f, -0.25f}, {0.9f, 0.46f, 0.25f});
  append(mesh, make_box({-0.9f, 0.55f, -0.3f}, {0.9f, 0.95f, -0.24f}));
  for (const float x : {-0.7f, 0.7f}) append(mesh, make_box({x - 0.04f, 0, -0.29f}, {x + 0.04f, 0.9f, 0.2f}));
  return mesh;
}

Mesh shelter() {
  Mesh mesh = make_box({-2, 2.3f, -0.8f}, {2, 2.45f, 0.8f});
  append(mesh, make_box({-1.95f, 0, -0.78f}, {1.95f, 2.35f, -0.7f}));
  for (const float x : {-1.9f, 1.85f}) append(mesh, make_box({x, 0, -0.72f}, {x + 0.05f, 2.35f, 0.7f}));
  return mesh;
}

Mesh water_tank(double detail) {
  const glm::vec2 profile[] = {{1.2f, 1.2f}, {1.2f, 3.2f}, {0, 4}};
  Mesh mesh = make_lathe(profile, round_section(scaled(12, detail, 3)));
  for (const float x : {-0.7f, 0.7f})
    for (const float z : {-0.7f, 0.7f}) append(mesh, make_box({x - 0.06f, 0, z - 0.06f}, {x + 0.06f, 1.3f, z + 0.06f}));
  return mesh;
}

Mesh mast(double detail) {
  const glm::vec2 profile[] = {{0.1f, 0}, {0.03f, 6}};
  Mesh mesh = make_lathe(profile, round_section(scaled(5, detail, 3)));
  for (const float y : {3.0f, 4.2f, 5.4f}) append(mesh, make_box({-0.8f, y, -0.03f}, {0.8f, y + 0.06f, 0.03f}));
  return mesh;
}

}  // namespace

CityParts::CityParts(Layout& layout) {
  const Mesh slab = make_box({-0.5f, -1, -0.5f}, {0.5f, 0, 0.5f});
  ground = layout.part("ground", slab);
  pavement = layout.part("pavement", slab);
  const float roof = static_cast<float>(city_roof);
  blocks = {layout.part("block", square_building({{0.5f, 0}, {0.5f, 1}, {0.47f, 1}, {0.47f, roof}})),
            layout.part("block", square_building({{0.5f, 0},
                                                  {0.5f, 0.22f},
                                                  {0.47f, 0.24f},
                                                  {0.47f, 0.9f},
                                                  {0.5f, 0.92f},
                                                  {0.5f, 1},
                                                  {0.46f, 1},
                                                  {0.46f, roof}})),
            layout.part("block", make_box({-0.5f, 0, -0.5f}, {0.5f, roof, 0.5f}))};
  towers = {
      layout.part("tower", square_building({{0.5f, 0},
                                            {0.5f, 0.3f},
                                            {0.4f, 0.3f},
                                            {0.4f, 0.6f},
                                            {0.3f, 0.6f},
                                            {0.3f, 0.85f},
                                            {0.2f, 0.85f},
                                            {0.2f, roof}})),
      layout.part("tower",
                  square_building({{0.5f, 0}, {0.5f, 0.12f}, {0.38f, 0.12f}, {0.38f, 1}, {0.36f, 1}, {0.36f, roof}})),
      layout.part("tower", square_building({{0.5f, 0}, {0.5f, 0.1f}, {0.44f, 0.1f}, {0.44f, 0.7f}, {0.25f, roof}})),
      layout.part("round tower", [](double detail) {
        const glm::vec2 profile[] = {{0.5f, 0},     {0.5f, 0.1f},  {0.42f, 0.1f},
                                     {0.42f, 0.9f}, {0.35f, 0.9f}, {0.35f, static_cast<float>(city_roof)}};
        return make_lathe(profile, round_section(scaled(16, detail, 5)));
      })};
  houses = {layout.part("house", gabled_house(0.6f, 0.05f)), layout.part("house", gabled_house(0.72f, 0.08f)),
            layout.part("house", hipped_house())};
  street_tree = layout.part("street tree", [](double detail) { return tree(detail, 7.5f, 4.5f, 1.1f); });
  garden_tree = layout.part("garden tree", [](double detail) { return tree(detail, 5, 4, 0.9f); });
  lamp = layout.part("lamp", sightline::lamp);
  car = layout.part("car", [](double detail) { return sightline::car(detail, 4.4f, -1.7f, 0.9f, 1.45f); });
  van = layout.part("van", [](double detail) { return sightline::car(detail, 5.2f, -2.5f, 1.6f, 2.2f); });
  bench = layout.part("bench", sightline::bench());
  bin = layout.part("bin", [](double detail) {
    const glm::vec2 profile[] = {{0.22f, 0}, {0.28f, 0.9f}, {0.2f, 1}};
    return make_lathe(profile, round_section(scaled(10, detail, 3)));
  });
  shelter = layout.part("shelter", sightline::shelter());
  planter = layout.part("planter", make_box({-0.6f, 0, -0.6f}, {0.6f, 0.7f, 0.6f}));
  shed = layout.part("shed", [] {
    Mesh mesh = gabled_house(0.7f, 0.1f);
    for (glm::vec3& p : mesh.positions) p *= glm::vec3(3, 2.6f, 2.4f);
    return mesh;
  }());
  hedge = layout.part("hedge", make_box({-2.5f, 0, -0.3f}, {2.5f, 1.4f, 0.3f}));
  chimney = layout.part("chimney", make_box({-0.4f, -1.5f, -0.3f}, {0.4f, 1.6f, 0.3f}));
  rooftop_unit = layout.part("rooftop unit", make_box({-1.4f, -0.05f, -0.9f}, {1.4f, 1.5f, 0.9f}));
  water_tank = layout.part("water tank", sightline::water_tank);
  mast = layout.part("mast", sightline::mast);
}

}  // namespace sightline
