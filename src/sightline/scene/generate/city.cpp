// A city on a plain: blocks between streets, closed rows of houses around back yards, towers towards the centre, parks;
// trees, lamps and cars along the streets. From the street the rows hide the yards, the roofs and the rest of the city.
#include <algorithm>
#include <cmath>

#include "sightline/scene/generate/city_parts.hpp"
#include "sightline/scene/generate/kinds.hpp"
#include "sightline/scene/generate/plot_grid.hpp"

namespace sightline {
namespace {

constexpr double block_x = 84, block_z = 56;  // between pavements' kerbs, metres
constexpr double street = 14;                 // from kerb to kerb
constexpr double kerb = 0.15;                 // the pavement's height
constexpr double walk = 3.5;                  // from kerb to facade
constexpr std::uint32_t objects_per_block = 60;

struct Plot {
  glm::dvec2 corner;    // of the block's pavement, the lowest x and z
  double centrality;    // 1 in the centre of the city, 0 at its edge
  std::uint32_t until;  // the layout's count of objects when the block is full
};

struct FlatRoof {
  glm::dvec3 centre;
  double half_x, half_z;  // free area around the centre
  bool pitched;
};

// Places along a block's outline, `pitch` apart, whose ends stay free; visited in an order that spreads them.
struct Slots {
  Slots(double slot_pitch, double free_corner)
      : pitch(slot_pitch),
        corner(free_corner),
        per_x(static_cast<std::uint32_t>((block_x - 2 * corner) / pitch)),
        per_z(static_cast<std::uint32_t>((block_z - 2 * corner) / pitch)),
        count(2 * (per_x + per_z)) {}

  // Metres along the outline of slot number i in 0 .. count - 1.
  [[nodiscard]] double position(std::uint32_t i) const {
    std::uint32_t slot = i * 31 % count;  // 31 shares no factor with the counts that the constants above give
    double start = corner;
    for (const bool along_x : {true, false, true, false}) {
      const std::uint32_t here = along_x ? per_x : per_z;
      if (slot < here) return start + pitch * (slot + 0.5);
      slot -= here;
      start += along_x ? block_x : block_z;
    }
    return start;
  }
  double pitch, corner;
  std::uint32_t per_x, per_z, count;
};

class BlockBuilder {
 public:
  BlockBuilder(Layout& layout, const CityParts& parts, const Plot& plot, std::uint64_t seed)
      : layout_(layout), parts_(parts), plot_(plot), random_(seed) {}

  void build() {
    if (!more()) return;
    layout_.place(parts_.pavement,
                  place_at(at(0.5 * block_x, 0.5 * block_z, kerb), 0, {block_x, kerb + 0.25, block_z}));
    const std::uint32_t budget = plot_.until - layout_.placed();
    const double kind = random_.uniform();
    if (kind < 0.3 * plot_.centrality * plot_.centrality)
      towers(std::min(4u, 1 + budget / 12));
    else if (kind < 0.93)
      rows(std::max(1u, budget / 4));
    furnish();
  }

 private:
  [[nodiscard]] bool more() const { return layout_.placed() < plot_.until; }
  [[nodiscard]] glm::dvec3 at(double x, double z, double y = kerb) const {
    return {plot_.corner.x + x, y, plot_.corner.y + z};
  }
  Part any(const std::vector<Part>& of) { return of[random_.below(static_cast<std::uint32_t>(of.size()))]; }

  // Footprint size_x by size_z around (x, z) of the block. Feet are sunk into the pavement.
  void house(double x, double z, double size_x, double size_z, bool ridge_along_x) {
    if (!more()) return;
    const bool pitched = random_.chance(0.8 - plot_.centrality);
    const double low = pitched ? random_.range(8, 13) : random_.range(11, 18);
    const double height = low + (pitched ? 0.0 : 14 * plot_.centrality * random_.uniform());
    const bool turned = pitched && !ridge_along_x;
    const glm::dvec3 scale = turned ? glm::dvec3(size_z, height, size_x) : glm::dvec3(size_x, height, size_z);
    layout_.place(any(pitched ? parts_.houses : parts_.blocks), place_at(at(x, z, 0.05), turned ? 0.25 : 0.0, scale));
    roofs_.push_back({at(x, z, 0.05 + height * (pitched ? 1.0 : city_roof)), 0.35 * size_x, 0.35 * size_z, pitched});
  }

  // A row of `count` houses whose party walls overlap by a hand, with fronts that are not quite in line.
  void row(std::uint32_t count, double from, double to, double front, double inward, bool along_x) {
    if (count == 0) return;
    std::vector<double> ends{0.0};
    for (std::uint32_t i = 0; i < count; ++i) ends.push_back(ends.back() + random_.range(0.7, 1.3));
    for (std::uint32_t i = 0; i < count; ++i) {
      const double a = from + (to - from) * ends[i] / ends.back(), b = from + (to - from) * ends[i + 1] / ends.back();
      const double setback = random_.range(0.0, 0.8), depth = random_.range(10.5, 13.0);
      const double along = 0.5 * (a + b), across = front + inward * (setback + 0.5 * depth);
      const double length = b - a + 0.2;
      if (along_x)
        house(along, across, length, depth, true);
      else
        house(across, along, depth, length, false);
    }
  }

  // Around the yard: two long rows along x, and where there is enough for it the gaps at both ends closed.
  void rows(std::uint32_t houses) {
    const std::uint32_t ends = houses >= 6 ? std::max(1u, houses / 7) : 0;
    const std::uint32_t rest = houses - 2 * ends;
    row(rest - rest / 2, walk, block_x - walk, walk, 1, true);
    row(rest / 2, walk, block_x - walk, block_z - walk, -1, true);
    row(ends, walk + 9, block_z - walk - 9, walk, 1, false);
    row(ends, walk + 9, block_z - walk - 9, block_x - walk, -1, false);
  }

  void towers(std::uint32_t count) {
    const std::uint32_t columns = count > 1 ? 2 : 1, lines = count > 2 ? 2 : 1;
    const double pitch_x = (block_x - 2 * walk) / columns, pitch_z = (block_z - 2 * walk) / lines;
    for (std::uint32_t i = 0; i < count && more(); ++i) {
      const std::uint32_t line = i / columns;
      const double x = walk + pitch_x * (i % columns + 0.5), z = walk + pitch_z * (line + 0.5);
      const double size_x = pitch_x * random_.range(0.6, 0.95), size_z = pitch_z * random_.range(0.7, 0.95);
      const double low = random_.range(35, 60);
      const double height = low + 90 * plot_.centrality * random_.uniform();
      layout_.place(any(parts_.towers), place_at(at(x, z, 0.05), 0, {size_x, height, size_z}));
      roofs_.push_back({at(x, z, 0.05 + height * city_roof), 0.1 * size_x, 0.1 * size_z, false});
    }
  }

  // Fills the block with what stands in streets, in yards and on roofs.
  void furnish() {
    const Slots cars(6.3, 6.0), things(3.7, 1.0);
    std::uint32_t cars_placed = 0, things_placed = 0;
    while (more()) {
      const double where = random_.uniform();
      if (where < 0.2 && !roofs_.empty())
        on_roof();
      else if (where < 0.45 && cars_placed < cars.count)
        at_kerb(cars.position(cars_placed++));
      else if (where < 0.7 && things_placed < things.count)
        on_walk(things.position(things_placed++));
      else
        in_yard();
    }
  }

  void on_roof() {
    const FlatRoof& roof = roofs_[random_.below(static_cast<std::uint32_t>(roofs_.size()))];
    const double dx = random_.range(-1, 1) * roof.half_x, dz = random_.range(-1, 1) * roof.half_z;
    if (roof.pitched)  // on the ridge
      layout_.place(parts_.chimney, place_at(roof.centre, random_.chance(0.5) ? 0.25 : 0.0));
    else {
      const Part part = random_.chance(0.6)   ? parts_.rooftop_unit
                        : random_.chance(0.5) ? parts_.water_tank
                                              : parts_.mast;
      layout_.place(part, place_at(roof.centre + glm::dvec3(dx, 0, dz), 0.25 * random_.below(4)));
    }
  }

  void in_yard() {
    const double x = random_.range(19, block_x - 19), z = random_.range(19, block_z - 19);
    const double kind = random_.uniform();
    const Part part = kind < 0.5    ? parts_.garden_tree
                      : kind < 0.65 ? parts_.shed
                      : kind < 0.85 ? parts_.hedge
                                    : parts_.bench;
    const double size = random_.range(0.75, 1.25), turns = random_.uniform();
    layout_.place(part, place_at(at(x, z), turns, glm::dvec3(size)));
  }

  // A point of the block's outline that lies `inside` metres within the kerb, and the turn that faces the street.
  void outline(double along, double inside, double& x, double& z, double& turns) const {
    if (along < block_x)
      x = along, z = inside, turns = 0.5;
    else if (along < block_x + block_z)
      x = block_x - inside, z = along - block_x, turns = 0.25;
    else if (along < 2 * block_x + block_z)
      x = 2 * block_x + block_z - along, z = block_z - inside, turns = 0.0;
    else
      x = inside, z = 2 * (block_x + block_z) - along, turns = 0.75;
  }

  void at_kerb(double along) {
    double x = 0, z = 0, turns = 0;
    const double shift = random_.range(-0.4, 0.4), inside = random_.range(-1.4, -1.15);
    outline(along + shift, inside, x, z, turns);
    const Part part = random_.chance(0.8) ? parts_.car : parts_.van;
    layout_.place(part, place_at(at(x, z, 0.0), turns + (random_.chance(0.2) ? 0.5 : 0.0)));
  }

  void on_walk(double along) {
    double x = 0, z = 0, turns = 0;
    outline(along, 0.7, x, z, turns);
    const double kind = random_.uniform();
    const Part part = kind < 0.4    ? parts_.street_tree
                      : kind < 0.65 ? parts_.lamp
                      : kind < 0.78 ? parts_.bin
                      : kind < 0.9  ? parts_.planter
                      : kind < 0.97 ? parts_.bench
                                    : parts_.shelter;
    const bool tree = part == parts_.street_tree;
    const double size = tree ? random_.range(0.8, 1.3) : 1.0;
    layout_.place(part, place_at(at(x, z), tree ? random_.uniform() : turns, glm::dvec3(size)));
  }

  Layout& layout_;
  const CityParts& parts_;
  Plot plot_;
  Random random_;
  std::vector<FlatRoof> roofs_;
};

}  // namespace

Scene generate_city(const GenerateConfig& config) {
  Layout layout(config);
  const CityParts parts(layout);
  if (config.objects == 1) {
    layout.place(parts.towers[0], place_at({0, 0, 0}, 0, {24, 80, 24}));
    return layout.build();
  }
  const PlotGrid grid(config.objects - 1, objects_per_block, {block_x, block_z}, street);
  layout.place(parts.ground, place_at({0, 0, 0}, 0, {grid.size().x + 60, 1, grid.size().y + 60}));
  for (std::uint32_t i = 0; i < grid.count; ++i) {
    Plot plot;
    plot.corner = grid.corner(i);
    const glm::dvec2 offset = (plot.corner + 0.5 * grid.plot) / (0.5 * grid.size());
    plot.centrality = std::max(0.0, 1.0 - std::sqrt(glm::dot(offset, offset)));
    plot.until = 1 + grid.until(i);
    BlockBuilder(layout, parts, plot, mix(config.seed, i + 1)).build();
  }
  return layout.build();
}

}  // namespace sightline
