// Depth complexity by construction: n parallel walls, each a closed box that covers all of the view, with small things
// between. n is half the square root of the number of objects (1 to 256). For an eye near the origin that looks along
// -z with at most 60 degrees by 16:9 every pixel's ray meets all n walls, and only what is before the first is seen.
#include <algorithm>
#include <cmath>

#include "sightline/scene/generate/kinds.hpp"
#include "sightline/scene/generate/layout.hpp"

namespace sightline {
namespace {

constexpr double first_wall = 10.0;  // metres from the origin to the first wall's front
constexpr double gap = 4.0;          // from front to front
constexpr double thickness = 0.25;

// Half the height of what is seen at a distance, with room to spare for eyes beside the origin.
double half_height(double distance) { return 0.75 * (distance + 4.0); }

}  // namespace

Scene generate_layers(const GenerateConfig& config) {
  Layout layout(config);
  const Part wall = layout.part("wall", make_box({-0.5f, -0.5f, -1}, {0.5f, 0.5f, 0}));
  const Part things[] = {
      layout.part("box", make_box(glm::vec3(-1), glm::vec3(1))),
      layout.part("ball", [](double detail) { return make_ball(scaled(10, detail, 3), scaled(6, detail, 2)); }),
      layout.part("pillar",
                  [](double detail) {
                    const glm::vec2 profile[] = {{0.5f, -1}, {0.3f, -0.8f}, {0.3f, 0.8f}, {0.5f, 1}};
                    return make_lathe(profile, round_section(scaled(10, detail, 3)));
                  }),
      layout.part("spike", [](double detail) {
        const glm::vec2 profile[] = {{0.8f, -1}, {0, 1}};
        return make_lathe(profile, round_section(scaled(8, detail, 3)));
      })};
  const auto walls = static_cast<std::uint32_t>(std::clamp(0.5 * std::sqrt(config.objects), 1.0, 256.0));
  Random random(config.seed, 1);
  for (std::uint32_t i = 0; i < walls; ++i) {
    const double front = first_wall + gap * i, height = 2 * half_height(front + thickness);
    layout.place(wall, place_at({0, 0, -front}, 0, {height * 16 / 9, height, thickness}));
  }
  // Between the walls, behind the last one and, for something to see, before the first.
  for (std::uint32_t i = 0; layout.left() > 0; ++i) {
    const double front = first_wall + gap * (i % (walls + 1)), across = half_height(front);
    const double size = random.range(0.1, 0.9), x = random.range(-1, 1) * across * 16 / 9;
    const double y = random.range(-1, 1) * across, inset = random.range(1.05, gap - thickness - 1.05);
    const double turns = random.uniform();
    layout.place(things[random.below(4)], place_at({x, y, -front + inset}, turns, glm::dvec3(size)));
  }
  return layout.build();
}

}  // namespace sightline
