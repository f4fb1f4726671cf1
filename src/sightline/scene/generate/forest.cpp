// A forest on hills: conifers, broad-leaved trees, bushes of loose leaves, stones, logs, with glades between. Trunks
// and leaves hide little each and much together; nothing is straight or aligned. Leaves are not closed, all else is.
#include <algorithm>
#include <cmath>

#include "sightline/scene/generate/kinds.hpp"
#include "sightline/scene/generate/layout.hpp"

namespace sightline {
namespace {

constexpr double area_per_object = 7.0;  // square metres
constexpr double depth_of_soil = 2.0;    // below the lowest ground, metres

// Smooth noise in -1 .. 1 by hashed lattice values; `scale` is the lattice's pitch in metres.
class Noise {
 public:
  Noise(std::uint64_t seed, double scale) : seed_(seed), scale_(scale) {}
  [[nodiscard]] double at(double x, double z) const {
    const double u = x / scale_, v = z / scale_, column = std::floor(u), row = std::floor(v);
    const double fu = fade(u - column), fv = fade(v - row);
    const double near = lattice(column, row) * (1 - fu) + lattice(column + 1, row) * fu;
    const double far = lattice(column, row + 1) * (1 - fu) + lattice(column + 1, row + 1) * fu;
    return near * (1 - fv) + far * fv;
  }

 private:
  static double fade(double t) { return t * t * (3 - 2 * t); }
  [[nodiscard]] double lattice(double column, double row) const {
    const auto c = static_cast<std::uint64_t>(static_cast<std::int64_t>(column));
    const auto r = static_cast<std::uint64_t>(static_cast<std::int64_t>(row));
    return static_cast<double>(mix(mix(seed_, c), r) >> 11) * 0x1p-52 - 1.0;
  }
  std::uint64_t seed_;
  double scale_;
};

class Hills {
 public:
  explicit Hills(std::uint64_t seed) : broad_(seed ^ 1, 90), fine_(seed ^ 2, 22) {}
  [[nodiscard]] double height(double x, double z) const { return 7 * broad_.at(x, z) + 1.2 * fine_.at(x, z); }

 private:
  Noise broad_, fine_;
};

// A closed piece of ground with `cells` by `cells` squares, in world space.
Mesh ground_tile(const Hills& hills, const glm::dvec2& low, const glm::dvec2& high, int cells) {
  Mesh mesh;
  const float bottom = static_cast<float>(-8.5 - depth_of_soil);
  const auto side = static_cast<std::uint32_t>(cells + 1);
  for (const bool top : {false, true})
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i) {
        const double x = low.x + (high.x - low.x) * i / cells, z = low.y + (high.y - low.y) * j / cells;
        mesh.positions.emplace_back(x, top ? static_cast<float>(hills.height(x, z)) : bottom, z);
      }
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  const std::uint32_t up = side * side;
  for (std::uint32_t j = 0; j + 1 < side; ++j)
    for (std::uint32_t i = 0; i + 1 < side; ++i) {
      const std::uint32_t a = j * side + i, b = a + 1, c = a + side, d = c + 1;
      quad(up + a, up + c, up + d, up + b);
      quad(a, b, d, c);
    }
  for (std::uint32_t i = 0; i + 1 < side; ++i) {
    const std::uint32_t last = side * (side - 1);
    quad(i, up + i, up + i + 1, i + 1);
    quad(last + i, last + i + 1, up + last + i + 1, up + last + i);
    quad(i * side, (i + 1) * side, up + (i + 1) * side, up + i * side);
    quad(i * side + side - 1, up + i * side + side - 1, up + (i + 1) * side + side - 1, (i + 1) * side + side - 1);
  }
  return mesh;
}

Mesh conifer(double detail, float height, int tiers) {
  const glm::vec2 trunk[] = {{0.22f, -0.6f}, {0.16f, 0.8f * height}};
  Mesh mesh = make_lathe(trunk, round_section(scaled(6, detail, 3)));
  for (int i = 0; i < tiers; ++i) {
    const float from = height * (0.18f + 0.75f * static_cast<float>(i) / static_cast<float>(tiers));
    const float to = from + 1.7f * height / static_cast<float>(tiers + 2);
    const float radius = 0.2f * height * (1.05f - static_cast<float>(i) / static_cast<float>(tiers));
    const glm::vec2 skirt[] = {{0.1f, from + 0.15f * (to - from)}, {radius, from}, {0, std::min(to, height)}};
    append(mesh, make_lathe(skirt, round_section(scaled(9, detail, 4))));
  }
  return mesh;
}

// A trunk, a few boughs and a crown of balls.
Mesh broadleaf(double detail, Random random, float height) {
  const glm::vec2 trunk[] = {{0.3f, -0.6f}, {0.2f, 0.3f * height}, {0.08f, 0.8f * height}};
  Mesh mesh = make_lathe(trunk, round_section(scaled(7, detail, 3)));
  for (int i = 0; i < 6; ++i) {
    const glm::dvec2 around = circle_point(i / 6.0 + random.range(-0.05, 0.05));
    const double reach = i == 0 ? 0.05 : random.range(0.14, 0.24), level = i == 0 ? 0.85 : random.range(0.55, 0.75);
    const glm::vec3 centre(around.x * reach * height, level * height, around.y * reach * height);
    const auto size = static_cast<float>(random.range(0.13, 0.19) * height);
    const glm::vec3 bough[] = {{0, 0.42f * height, 0}, centre};
    append(mesh, make_pipe(bough, 0.07f, scaled(5, detail, 3)));
    append(mesh, make_ball(scaled(8, detail, 4), scaled(5, detail, 2)),
           {{size, 0, 0}, {0, 0.8f * size, 0}, {0, 0, size}, centre});
  }
  return mesh;
}

// Loose quads in a half ball of radius 1.
Mesh leaves(double detail, Random random, int natural_count) {
  Mesh mesh;
  const int count = scaled(natural_count, detail * detail, 4);
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 out = random.direction(), along = random.direction();
    const glm::dvec3 centre = glm::abs(out) * glm::dvec3(0, 1, 0) + out * glm::dvec3(1, 0, 1);
    const double size = random.range(0.1, 0.25), distance = random.range(0.4, 1.0);
    const glm::dvec3 u = size * glm::normalize(glm::cross(out, along)), v = 0.6 * glm::cross(out, u);
    const glm::vec3 p(centre * distance), du(u), dv(v);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {p - du - dv, p + du - dv, p + du + dv, p - du + dv});
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }
  return mesh;
}

// A ball whose vertices are pushed in and out, the same for every tessellation.
Mesh stone(double detail, std::uint64_t seed) {
  Mesh mesh = make_ball(scaled(8, detail, 4), scaled(5, detail, 2));
  const Noise noise(seed, 0.7);
  for (glm::vec3& p : mesh.positions)
    p *= glm::vec3(1, 0.6f, 0.8f) * static_cast<float>(1 + 0.35 * noise.at(p.x + 0.5 * p.y, p.z - 0.7 * p.y));
  return mesh;
}

struct ForestParts {
  ForestParts(Layout& layout, std::uint64_t seed) {
    for (const float height : {9.0f, 14.0f, 19.0f})
      trees.push_back(layout.part("conifer", [=](double d) { return conifer(d, height, height < 10 ? 4 : 6); }));
    for (std::uint64_t i = 0; i < 3; ++i)
      trees.push_back(layout.part("broad-leaved tree", [=](double d) {
        return broadleaf(d, Random(seed, 40 + i), 9 + 3 * static_cast<float>(i));
      }));
    for (std::uint64_t i = 0; i < 2; ++i) {
      bushes.push_back(layout.part("bush", [=](double d) { return leaves(d, Random(seed, 50 + i), 60); }));
      bushes.push_back(layout.part("fern", [=](double d) { return leaves(d, Random(seed, 60 + i), 14); }));
      stones.push_back(layout.part("stone", [=](double d) { return stone(d, seed + i); }));
    }
    log = layout.part("log", [](double d) { return make_cylinder(scaled(8, d, 3)); });
  }
  std::vector<Part> trees, bushes, stones;
  Part log;
};

void place_ground(Layout& layout, const Hills& hills, double side, std::uint32_t tiles) {
  for (std::uint32_t j = 0; j < tiles; ++j)
    for (std::uint32_t i = 0; i < tiles; ++i) {
      const glm::dvec2 low = glm::dvec2(i, j) * (side / tiles) - 0.5 * side;
      const glm::dvec2 high = glm::dvec2(i + 1, j + 1) * (side / tiles) - 0.5 * side;
      layout.place(
          layout.part("ground", [=](double detail) { return ground_tile(hills, low, high, scaled(14, detail, 1)); }),
          identity_affine());
    }
}

// One thing of the forest at a place that is known to be in the woods.
void grow(Layout& layout, const ForestParts& parts, Random& random, const glm::dvec3& place) {
  const auto any = [&](const std::vector<Part>& of) { return of[random.below(static_cast<std::uint32_t>(of.size()))]; };
  const double kind = random.uniform(), turns = random.uniform(), size = random.middling(0.6, 1.4);
  if (kind < 0.5)
    layout.place(any(parts.trees), place_at(place, turns, glm::dvec3(size)));
  else if (kind < 0.82)
    layout.place(any(parts.bushes), place_at(place, turns, glm::dvec3(0.9 * size)));
  else if (kind < 0.93)
    layout.place(any(parts.stones), place_at(place, turns, glm::dvec3(0.7 * size)));
  else {  // lying
    const glm::dvec2 along = circle_point(turns);
    const double length = 5 * size;
    layout.place(parts.log, {glm::vec3(0, 0.25, 0), glm::vec3(along.x * length, 0, along.y * length),
                             glm::vec3(along.y * 0.25, 0, -along.x * 0.25), glm::vec3(place) + glm::vec3(0, 0.2, 0)});
  }
}

}  // namespace

Scene generate_forest(const GenerateConfig& config) {
  Layout layout(config);
  const ForestParts parts(layout, config.seed);
  const Hills hills(config.seed);
  const Noise glades(config.seed ^ 3, 22);
  const double side = std::max(12.0, std::sqrt(area_per_object * config.objects));
  const auto tiles = static_cast<std::uint32_t>(std::clamp(side / 40, 1.0, 16.0));
  if (config.objects > 4) place_ground(layout, hills, side, tiles);
  Random random(config.seed, 1);
  const double start_x = random.uniform(), start_z = random.uniform();
  // An additive recurrence with the plastic number spreads places evenly without a pattern (Roberts 2018).
  for (std::uint64_t i = 1; layout.left() > 0; ++i) {
    const double a = start_x + 0.7548776662466927 * static_cast<double>(i),
                 b = start_z + 0.5698402909980532 * static_cast<double>(i);
    const double x = (a - std::floor(a) - 0.5) * (side - 2), z = (b - std::floor(b) - 0.5) * (side - 2);
    const bool crowded = i > 4ull * config.objects;  // a small forest may lie in a glade altogether
    if (config.objects > 4 && !crowded && glades.at(x, z) > 0.45) continue;
    grow(layout, parts, random, {x, hills.height(x, z) - 0.1, z});
  }
  return layout.build();
}

}  // namespace sightline
