// An office building: storeys of rooms along corridors that a cross corridor joins, a staircase, windows, furniture.
// One cell per room and corridor and one for the outside, a portal for every door, window, passage and stair opening
// (checklist 25.01). The cells of the inside tile it; the last cell is the outside and its bounds hold everything, so
// the first cell whose bounds contain a point is the cell of that point. Below 48 objects it is a fragment without
// cells.
#include <algorithm>

#include "sightline/scene/generate/building_furnish.hpp"
#include "sightline/scene/generate/kinds.hpp"

namespace sightline {
namespace {

using namespace building;

constexpr std::uint32_t objects_per_room = 24;
constexpr std::uint32_t least_objects = 48;

struct Line {  // where a wall stands: its start on the floor and whether it runs along x or z
  glm::dvec3 start;
  bool along_x;
};

class Structure {
 public:
  Structure(Layout& layout, const BuildingParts& parts, const BuildingPlan& plan, std::uint64_t seed)
      : layout_(layout), parts_(parts), plan_(plan), random_(seed, 1) {}

  void build() {
    layout_.place(parts_.ground, place_at({0.5 * plan_.length_x(), -0.1875, 0.5 * plan_.length_z()}, 0,
                                          {plan_.length_x() + 60, 1, plan_.length_z() + 60}));
    for (std::uint32_t s = 0; s <= plan_.storeys; ++s) slabs(s);
    for (std::uint32_t s = 0; s < plan_.storeys; ++s) {
      for (std::uint32_t row = 0; row < plan_.rows; ++row) {
        walls_along_row(s, row);
        walls_across_row(s, row);
      }
      back_walls(s);
      cross_corridor(s);
      if (s + 1 < plan_.storeys) stairs(s);
    }
  }

 private:
  // Floor `s`, which is the roof if s is the number of storeys.
  void slabs(std::uint32_t s) {
    const double y = s * storey;
    for (std::uint32_t row = 0; row < plan_.rows; ++row) {
      for (std::uint32_t side = 0; side < 2; ++side)
        for (std::uint32_t b = 0; b < plan_.bays; ++b) {
          const bool stair = row == 0 && side == 1 && b + 1 == plan_.bays && s > 0 && s < plan_.storeys;
          const glm::dvec3 corner(b * bay, y, BuildingPlan::room_z(row, side));
          if (stair)
            layout_.place(parts_.stair_slab, place_at(corner));
          else
            layout_.place(parts_.floor_slab, place_at(corner, 0, {bay, 1, depth}));
        }
      layout_.place(parts_.floor_slab,
                    place_at({0, y, BuildingPlan::corridor_z(row)}, 0, {plan_.length_x(), 1, corridor}));
    }
    layout_.place(parts_.floor_slab, place_at({-corridor, y, 0}, 0, {corridor, 1, plan_.length_z()}));
  }

  // Places a wall between two cells, with a portal for each of its openings and, where asked, panes or doors in them.
  void wall(const WallKind& kind, const Line& line, std::uint32_t cell_a, std::uint32_t cell_b, double glazed,
            double doors) {
    layout_.place(kind.part, place_at(line.start, line.along_x ? 0.0 : 0.75));
    for (const Opening& opening : kind.openings) {
      portal(opening, line, cell_a, cell_b);
      const bool is_window = opening.bottom > 0.5f;
      const glm::dvec3 along = line.along_x ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1);
      const double width = opening.right - opening.left;
      if (is_window && random_.chance(glazed))
        layout_.place(parts_.pane,
                      place_at(line.start + along * double(opening.left) + glm::dvec3(0, opening.bottom, 0),
                               line.along_x ? 0.0 : 0.75, {width, opening.top - opening.bottom, 1}),
                      false);
      if (!is_window && width == 1.0 && random_.chance(doors)) {
        // Shut, ajar or wide open, on either side of the wall.
        const double swing = random_.chance(0.3) ? 0.0 : random_.range(0.03, 0.27);
        layout_.place(parts_.door, place_at(line.start + along * double(opening.left),
                                            (line.along_x ? 0.0 : 0.75) + (random_.chance(0.5) ? swing : -swing)));
      }
    }
  }

  void portal(const Opening& opening, const Line& line, std::uint32_t cell_a, std::uint32_t cell_b) {
    const auto corner = [&](float along, float height) {
      const glm::dvec3 step = line.along_x ? glm::dvec3(along, 0, 0) : glm::dvec3(0, 0, along);
      return glm::vec3(line.start + step + glm::dvec3(0, std::max(0.0f, height), 0));
    };
    layout_.portals.push_back({{cell_a, cell_b},
                               {corner(opening.left, opening.bottom), corner(opening.right, opening.bottom),
                                corner(opening.right, opening.top), corner(opening.left, opening.top)}});
  }

  const WallKind& any(const std::vector<WallKind>& kinds, double first) {
    if (random_.chance(first)) return kinds[0];
    return kinds[1 + random_.below(static_cast<std::uint32_t>(kinds.size() - 1))];
  }

  void walls_along_row(std::uint32_t s, std::uint32_t row) {
    const double y = s * storey, z = BuildingPlan::corridor_z(row);
    for (std::uint32_t side = 0; side < 2; ++side)
      for (std::uint32_t b = 0; b < plan_.bays; ++b) {
        const Line line{{b * bay, y, z + side * corridor}, true};
        wall(any(parts_.corridor_walls, 0.7), line, plan_.room(s, row, side, b), plan_.corridor(s, row), 0.8, 0.75);
      }
  }

  // The outer walls along x, and the walls between rooms that stand back to back.
  void back_walls(std::uint32_t s) {
    const double y = s * storey;
    for (std::uint32_t row = 0; row <= plan_.rows; ++row)
      for (std::uint32_t b = 0; b < plan_.bays; ++b) {
        const Line line{{b * bay, y, row * BuildingPlan::row_pitch}, true};
        if (row == 0)
          wall(any(parts_.facades, 0.6), line, plan_.room(s, 0, 0, b), plan_.outside(), 0.7, 0);
        else if (row == plan_.rows)
          wall(any(parts_.facades, 0.6), line, plan_.room(s, row - 1, 1, b), plan_.outside(), 0.7, 0);
        else
          wall(random_.chance(0.2) ? parts_.back_door : parts_.back, line, plan_.room(s, row - 1, 1, b),
               plan_.room(s, row, 0, b), 0, 0.8);
      }
  }

  void walls_across_row(std::uint32_t s, std::uint32_t row) {
    const double y = s * storey;
    for (std::uint32_t side = 0; side < 2; ++side)
      for (std::uint32_t b = 0; b <= plan_.bays; ++b) {
        const Line line{{b * bay, y, BuildingPlan::room_z(row, side)}, false};
        if (b == 0)
          wall(parts_.partition, line, plan_.cross_corridor(s), plan_.room(s, row, side, 0), 0, 0);
        else if (b == plan_.bays)
          wall(parts_.end_facade, line, plan_.room(s, row, side, b - 1), plan_.outside(), 0.7, 0);
        else
          wall(random_.chance(0.15) ? parts_.partition_door : parts_.partition, line, plan_.room(s, row, side, b - 1),
               plan_.room(s, row, side, b), 0, 0.8);
      }
    const double z = BuildingPlan::corridor_z(row);
    wall(parts_.end_window, {{plan_.length_x(), y, z}, false}, plan_.corridor(s, row), plan_.outside(), 0.7, 0);
    // Between corridor and cross corridor there is no wall: the portal is all of the free cross-section.
    const float inset = 0.0625f;
    portal({inset, 0, static_cast<float>(corridor) - inset, static_cast<float>(ceiling)}, {{0, y, z}, false},
           plan_.cross_corridor(s), plan_.corridor(s, row));
  }

  // Its three outer walls.
  void cross_corridor(std::uint32_t s) {
    const double y = s * storey;
    const std::uint32_t cell = plan_.cross_corridor(s);
    for (std::uint32_t row = 0; row < plan_.rows; ++row) {
      for (std::uint32_t side = 0; side < 2; ++side)
        wall(parts_.end_facade, {{-corridor, y, BuildingPlan::room_z(row, side)}, false}, cell, plan_.outside(), 0.7,
             0);
      wall(parts_.end_solid, {{-corridor, y, BuildingPlan::corridor_z(row)}, false}, cell, plan_.outside(), 0, 0);
    }
    wall(s == 0 ? parts_.entrance : parts_.end_window, {{-corridor, y, 0}, true}, cell, plan_.outside(), 0.7, 1);
    wall(parts_.end_window, {{-corridor, y, plan_.length_z()}, true}, cell, plan_.outside(), 0.7, 0);
  }

  void stairs(std::uint32_t s) {
    const double x = (plan_.bays - 1) * bay, z = BuildingPlan::room_z(0, 1);
    layout_.place(parts_.stairs,
                  place_at({x + stair_opening.left, s * storey, z + 0.5 * (stair_opening.bottom + stair_opening.top)}));
    const double y = (s + 1) * storey - 0.5 * slab;
    const auto corner = [&](float along, float across) { return glm::vec3(x + along, y, z + across); };
    layout_.portals.push_back(
        {{plan_.stair_room(s), plan_.stair_room(s + 1)},
         {corner(stair_opening.left, stair_opening.bottom), corner(stair_opening.right, stair_opening.bottom),
          corner(stair_opening.right, stair_opening.top), corner(stair_opening.left, stair_opening.top)}});
  }

  Layout& layout_;
  const BuildingParts& parts_;
  const BuildingPlan& plan_;
  Random random_;
};

// Every object into the cells that it touches.
void fill_cells(Layout& layout, const BuildingPlan& plan) {
  Aabb everything;
  for (ObjectId id = 0; id < layout.placed(); ++id) {
    const Aabb box = layout.bounds(id);
    everything.extend(box);
    for (const std::uint32_t cell : cells_touching(plan, layout.cells, box)) layout.cells[cell].objects.push_back(id);
  }
  Aabb& outside = layout.cells[plan.outside()].bounds;
  outside = {everything.lo - 1.0f, everything.hi + glm::vec3(1, 30, 1)};
}

}  // namespace

Scene generate_building(const GenerateConfig& config) {
  Layout layout(config);
  const BuildingParts parts(layout);
  const BuildingPlan plan = plan_building(std::max(2u, config.objects / objects_per_room));
  Structure(layout, parts, plan, config.seed).build();
  furnish_building(layout, parts, plan, config.seed);
  if (config.objects < least_objects) {
    layout.keep_first(config.objects);
    layout.portals.clear();
  } else {
    layout.cells = building_cells(plan);
    fill_cells(layout, plan);
  }
  return layout.build();
}

}  // namespace sightline
