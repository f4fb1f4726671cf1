#include "sightline/scene/generate/building_furnish.hpp"

#include <algorithm>

namespace sightline {
namespace {

using namespace building;

// One room; u runs along the bay, v from the corridor's wall into the depth, both in metres from the room's corner.
class Room {
 public:
  Room(Layout& layout, const BuildingParts& parts, const glm::dvec3& corner, bool mirrored, std::uint32_t until,
       Random random)
      : layout_(layout), parts_(parts), corner_(corner), mirrored_(mirrored), until_(until), random_(random) {}

  void furnish(bool has_stairs) {
    if (has_stairs)
      keep_clear_ = true;
    else {
      put(parts_.ceiling_lamp, 2.5, 3, 0, ceiling);
      const double use = random_.uniform();
      if (use < 0.45)
        office();
      else if (use < 0.65)
        meeting();
      else if (use < 0.85)
        bedroom();
      else
        lounge();
    }
    clutter();
  }

 private:
  [[nodiscard]] bool more() const { return layout_.placed() < until_; }

  // `turns` is the way the back faces: 0 towards the corridor, 0.5 towards the far wall.
  void put(Part part, double u, double v, double turns, double y = 0.0, double size = 1.0) {
    if (!more()) return;
    const double x = u, z = mirrored_ ? depth - v : v;
    layout_.place(part, place_at(corner_ + glm::dvec3(x, y, z), mirrored_ ? 0.5 - turns : turns, glm::dvec3(size)));
  }

  void put(const Furniture& piece, double u, double v, double turns) {
    if (!more()) return;
    put(piece.part, u, v, turns);
    pieces_.push_back({piece, u, v, turns});
  }

  void office() {
    for (const double u : {1.3, 3.7}) {
      put(parts_.desk, u, 5.2, 0.5);
      const double shift = random_.range(-0.2, 0.2), turns = random_.range(-0.1, 0.1);
      put(parts_.chair, u + shift, 4.5, turns);
      put(parts_.things[0], u, 5.2, 0.5, parts_.desk.surface);
    }
    storage(4);
  }

  void meeting() {
    for (const double u : {1.5, 3.5}) {
      put(parts_.table, u, 3, 0);
      for (const double du : {-0.5, 0.5}) {
        put(parts_.chair, u + du, 3.75, 0.5 + random_.range(-0.05, 0.05));
        put(parts_.chair, u + du, 2.25, random_.range(-0.05, 0.05));
      }
    }
    storage(1);
  }

  void bedroom() {
    put(parts_.bed, 1.2, 4.75, 0.5);
    put(parts_.bed, 3.6, 4.75, 0.5);
    put(parts_.floor_lamp, 2.4, 5.6, 0);
    put(parts_.stool, 2.4, 4.9, 0);
    storage(3);
  }

  void lounge() {
    put(parts_.sofa, 2.5, 5.3, 0.5);
    put(parts_.sideboard, 2.5, 3.9, 0.5);
    put(parts_.stool, 1.4, 4.0, 0);
    put(parts_.stool, 3.7, 4.0, 0);
    put(parts_.plant, 0.5, 5.5, 0);
    put(parts_.floor_lamp, 4.5, 5.5, 0);
    storage(2);
  }

  // Tall pieces with their backs to the two side walls, clear of the doors in them.
  void storage(std::uint32_t count) {
    const double places[][3] = {{0.4, 3.1, 0.25}, {4.6, 1.4, 0.75}, {4.6, 2.9, 0.75}, {0.3, 1.9, 0.25}};
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto& [u, v, turns] = places[i % 4];
      put(random_.chance(0.5) ? parts_.shelf : parts_.cupboard, u, v, turns);
    }
  }

  // Whatever is left goes on to surfaces; where there are none, on to the floor along the far wall.
  void clutter() {
    while (more()) {
      const Part thing = parts_.things[random_.below(static_cast<std::uint32_t>(parts_.things.size()))];
      const double turns = random_.uniform();
      if (pieces_.empty() || random_.chance(0.1)) {
        const double v = keep_clear_ ? random_.range(3.5, 5.7) : random_.range(1.4, 5.7);
        const double u = random_.range(0.3, 4.7);
        put(random_.chance(0.2) ? parts_.plant : thing, u, v, turns);
        continue;
      }
      const Placed& piece = pieces_[random_.below(static_cast<std::uint32_t>(pieces_.size()))];
      const double a = random_.range(-1, 1) * piece.kind.half_x, b = random_.range(-1, 1) * piece.kind.half_z;
      const glm::dvec2 c = circle_point(piece.turns);
      put(thing, piece.u + a * c.x + b * c.y, piece.v - a * c.y + b * c.x, turns, piece.kind.surface);
    }
  }

  struct Placed {
    Furniture kind;
    double u, v, turns;
  };
  Layout& layout_;
  const BuildingParts& parts_;
  glm::dvec3 corner_;
  bool mirrored_;
  bool keep_clear_ = false;
  std::uint32_t until_;
  Random random_;
  std::vector<Placed> pieces_;
};

// Lamps, plants and benches along a strip of floor, for corridors.
void furnish_strip(Layout& layout, const BuildingParts& parts, const glm::dvec3& start, double length, bool along_x,
                   std::uint32_t until, Random random) {
  while (layout.placed() < until) {
    const double along = random.range(0.5, length - 0.5), across = random.chance(0.5) ? 0.4 : corridor - 0.4;
    const bool hanging = random.chance(0.4);
    const glm::dvec3 offset(along, hanging ? ceiling : 0.0, hanging ? 0.5 * corridor : across);
    const Part part = hanging ? parts.ceiling_lamp : random.chance(0.5) ? parts.plant : parts.stool;
    layout.place(part, place_at(start + (along_x ? offset : glm::dvec3(offset.z, offset.y, offset.x))));
  }
}

void plant_trees(Layout& layout, const BuildingParts& parts, const BuildingPlan& plan, std::uint32_t until,
                 Random random) {
  while (layout.placed() < until) {
    const double around = random.range(5, 24), x = random.range(-24, plan.length_x() + 24);
    const double z = random.chance(0.5) ? -around : plan.length_z() + around, size = random.range(0.8, 1.6);
    layout.place(parts.tree, place_at({x, -0.1875, z}, random.uniform(), glm::dvec3(size)));
  }
}

}  // namespace

void furnish_building(Layout& layout, const BuildingParts& parts, const BuildingPlan& plan, std::uint64_t seed) {
  const std::uint32_t start = layout.placed(), count = layout.left();
  const auto share = [&](double part) { return start + static_cast<std::uint32_t>(count * part); };
  plant_trees(layout, parts, plan, share(0.02), Random(seed, 2));
  const double corridors = plan.storeys * (plan.rows + 1.0);
  double done = 0;
  for (std::uint32_t s = 0; s < plan.storeys; ++s) {
    const double y = s * storey;
    for (std::uint32_t row = 0; row <= plan.rows; ++row) {
      const bool cross = row == plan.rows;
      const glm::dvec3 corner = cross ? glm::dvec3(-corridor, y, 0) : glm::dvec3(0, y, BuildingPlan::corridor_z(row));
      done += 1;
      furnish_strip(layout, parts, corner, cross ? plan.length_z() : plan.length_x(), !cross,
                    share(0.02 + 0.06 * done / corridors), Random(seed, 1000 + s * (plan.rows + 1) + row));
    }
  }
  const double rooms = 2.0 * plan.storeys * plan.rows * plan.bays;
  const std::uint32_t rooms_start = layout.placed(), rooms_count = layout.left();
  done = 0;
  for (std::uint32_t s = 0; s < plan.storeys; ++s)
    for (std::uint32_t row = 0; row < plan.rows; ++row)
      for (std::uint32_t side = 0; side < 2; ++side)
        for (std::uint32_t b = 0; b < plan.bays; ++b) {
          done += 1;
          const std::uint32_t until = done >= rooms
                                          ? rooms_start + rooms_count
                                          : rooms_start + static_cast<std::uint32_t>(rooms_count * done / rooms);
          const glm::dvec3 corner(b * bay, s * storey, BuildingPlan::room_z(row, side));
          const std::uint32_t cell = plan.room(s, row, side, b);
          Room(layout, parts, corner, side == 0, until, Random(seed, (std::uint64_t{1} << 32) + cell))
              .furnish(plan.storeys > 1 && cell == plan.stair_room(s));
        }
}

}  // namespace sightline
