// An industrial plant: plots of pipe racks, tanks, steel structures with vessels, and pumps, along roads. Thousands of
// thin things that hide little each: pipes, girders, gratings, ladders, valves.
#include <algorithm>
#include <cmath>

#include "sightline/scene/generate/kinds.hpp"
#include "sightline/scene/generate/plant_parts.hpp"
#include "sightline/scene/generate/plot_grid.hpp"

namespace sightline {
namespace {

constexpr double plot_x = 42, plot_z = 30, road = 6;  // metres
constexpr std::uint32_t objects_per_plot = 240;
constexpr double bay = 6;  // between columns

class PlotBuilder {
 public:
  PlotBuilder(Layout& layout, const PlantParts& parts, const glm::dvec2& corner, std::uint32_t until,
              std::uint64_t seed)
      : layout_(layout), parts_(parts), corner_(corner), until_(until), random_(seed) {}

  void build() {
    const double kind = random_.uniform();
    if (kind < 0.35)
      rack();
    else if (kind < 0.55)
      tanks();
    else if (kind < 0.85)
      structure();
    else
      pumps();
    while (more()) clutter();
  }

 private:
  [[nodiscard]] bool more() const { return layout_.placed() < until_; }
  void put(Part part, const glm::dvec3& at, double turns = 0, const glm::dvec3& scale = glm::dvec3(1)) {
    if (more()) layout_.place(part, place_at({corner_.x + at.x, at.y, corner_.y + at.z}, turns, scale));
  }

  // Steel that stands at (x, z), and girders along x and z from a point.
  void column(double x, double z, double height) { put(parts_.column, {x, 0, z}, 0, {1, height, 1}); }
  void girder(const glm::dvec3& from, double length, bool along_x) {
    put(parts_.girder, from, along_x ? 0.0 : 0.75, {length, 1, 1});
  }

  // A straight pipe along x or z that leaves things to hang valves and flanges on.
  void pipe(const glm::dvec3& from, double length, double radius, bool along_x) {
    put(parts_.pipe, from, along_x ? 0.0 : 0.75, {length, radius, radius});
    runs_.push_back({from, length, radius, along_x});
  }

  // Portals of two columns and a girder per level, pipes on the levels.
  void rack() {
    const std::uint32_t frames = 7, levels = 2 + random_.below(2);
    const double width = random_.range(6, 9), z0 = 0.5 * (plot_z - width), height = 4.5 + 2.2 * levels;
    for (std::uint32_t i = 0; i < frames; ++i) {
      const double x = 3 + bay * i;
      for (const double z : {z0, z0 + width}) column(x, z, height);
      for (std::uint32_t level = 0; level < levels; ++level) girder({x, 4.5 + 2.2 * level, z0}, width, false);
    }
    for (std::uint32_t level = 0; level < levels; ++level) {
      const double y = 4.5 + 2.2 * level;
      for (const double z : {z0, z0 + width}) girder({3, y - 0.6, z}, bay * (frames - 1), true);
      double z = z0 + 0.5;
      while (z < z0 + width - 0.5 && more()) {
        const double radius = random_.chance(0.2) ? random_.range(0.2, 0.4) : random_.range(0.05, 0.15);
        z += radius;
        pipe({1, y + 0.16 + radius, z}, plot_x - 2, radius, true);
        z += radius + random_.range(0.15, 0.5);
      }
      put(parts_.tray, {1, y + 0.2, z0 + 0.25}, 0, {plot_x - 2, 1, 1});
    }
    for (double x = 5; x < plot_x - 8; x += 8) put(parts_.pump, {x, 0, 0.5 * plot_z}, 0.25 * random_.below(4));
    for (const double x : {3.0, 21.0, 39.0}) climb({x, 0, z0 - 0.2}, 0.5, static_cast<int>(height / 3));
  }

  // Ladders above each other.
  void climb(const glm::dvec3& foot, double turns, int storeys) {
    for (int i = 0; i < storeys; ++i) put(parts_.ladder, foot + glm::dvec3(0, 3.0 * i, 0), turns);
  }

  // Tanks within a low wall.
  void tanks() {
    for (const double z : {1.0, plot_z - 1}) put(parts_.dike, {1, 0, z}, 0, {plot_x - 2, random_.range(0.9, 1.3), 1});
    for (const double x : {1.0, plot_x - 1})
      put(parts_.dike, {x, 0, 1}, 0.75, {plot_z - 2, random_.range(0.9, 1.3), 1});
    const bool spheres = random_.chance(0.3);
    for (const double z : {8.5, 21.5})
      for (const double x : {8.0, 21.0, 34.0}) {
        const double radius = random_.range(3.5, 5.6), height = random_.range(7, 14), bore = random_.range(0.1, 0.2);
        if (spheres)
          put(parts_.sphere, {x, 0, z}, 0, glm::dvec3(0.9 * radius));
        else
          tank(x, z, radius, height);
        pipe({x + radius - 0.3, 0.6, z}, 10 - radius, bore, true);
      }
    pipe({2, 0.5, 0.5 * plot_z}, plot_x - 4, 0.2, true);
    pipe({14.5, 0.45, 2}, plot_z - 4, 0.2, false);
  }

  // With a ladder, and a handrail of eight pieces around the roof.
  void tank(double x, double z, double radius, double height) {
    put(parts_.tank, {x, 0, z}, 0, {radius, height, radius});
    climb({x, 0, z + radius}, 0.0, static_cast<int>(0.88 * height / 3));
    const double rail = 0.92 * radius, piece = 2 * rail * circle_point(0.0625).y;  // a side of the octagon
    for (int k = 0; k < 8; ++k) {
      const glm::dvec2 start = circle_point((k - 0.5) / 8.0) * rail;
      put(parts_.handrail, {x + start.x, 0.9 * height, z - start.y}, k / 8.0 + 0.25, {piece / 3, 1, 1});
    }
  }

  // Levels of girders and gratings, vessels on them, stairs of ladders.
  void structure() {
    const std::uint32_t bays_x = 4, bays_z = 2, levels = 2 + random_.below(4);
    const double rise = 4.5, x0 = 8, z0 = 8;
    for (std::uint32_t i = 0; i <= bays_x; ++i)
      for (std::uint32_t j = 0; j <= bays_z; ++j) column(x0 + bay * i, z0 + bay * j, rise * levels + 1);
    for (std::uint32_t level = 0; level <= levels; ++level) {
      const double y = rise * level;
      if (level > 0) floor(x0, y, z0, bays_x, bays_z);
      for (std::uint32_t i = 0; i < bays_x * bays_z; ++i) {
        const std::uint32_t line = i / bays_x;
        const glm::dvec3 centre(x0 + bay * (i % bays_x + 0.5), y, z0 + bay * (line + 0.5));
        const double kind = random_.uniform(), size = random_.range(0.5, 0.8);
        if (kind < 0.3)
          put(parts_.vessel, centre, 0, glm::dvec3(size));
        else if (kind < 0.55)
          put(parts_.reactor, centre, size, {size, level == levels ? 1.2 : 0.55, size});
        else if (kind < 0.7)
          put(parts_.pump, centre, 0.25 * random_.below(4));
        const double above = random_.range(2.9, 3.7), radius = random_.range(0.06, 0.14);
        pipe(centre + glm::dvec3(-2.6, above, 1.8), 5.2, radius, true);
      }
      if (level < levels) {
        put(parts_.ladder, {x0 + bay * bays_x + 0.25, y, z0 + 1.5}, 0.25, {1, rise / 3, 1});
        put(parts_.tray, {x0, y + 3.9, z0 + 0.5}, 0, {bay * bays_x, 1, 1});
      }
    }
  }

  void floor(double x0, double y, double z0, std::uint32_t bays_x, std::uint32_t bays_z) {
    for (std::uint32_t j = 0; j <= bays_z; ++j) girder({x0, y - 0.25, z0 + bay * j}, bay * bays_x, true);
    for (std::uint32_t i = 0; i <= bays_x; ++i) girder({x0 + bay * i, y - 0.26, z0}, bay * bays_z, false);
    for (std::uint32_t i = 0; i < bays_x * bays_z; ++i) {
      const std::uint32_t line = i / bays_x;
      const glm::dvec3 corner(x0 + bay * (i % bays_x), y, z0 + bay * line);
      if (random_.chance(0.15)) continue;  // a hole in the floor
      put(random_.chance(0.6) ? parts_.grating : parts_.platform, corner, 0, {bay, 1, bay});
    }
    for (std::uint32_t i = 0; i < 2 * bays_x; ++i)
      for (const double z : {z0, z0 + bay * bays_z}) put(parts_.handrail, {x0 + 3.0 * i, y, z});
  }

  void pumps() {
    for (int row = 0; row < 3; ++row)
      for (int i = 0; i < 9; ++i) {
        const double x = 4 + 4.2 * i, z = 5 + 9 * row;
        put(parts_.pump, {x, 0, z}, 0.25);
        put(parts_.bends[1], {x, 1.25, z}, 0.25 * random_.below(4));
        if (i % 4 == 1) put(parts_.vessel, {x, 0, z + 4.2}, 0, glm::dvec3(0.7));
      }
    for (int row = 0; row < 3; ++row)
      for (double dz = 0; dz < 1.2; dz += 0.4) pipe({2, 3.2 + 0.1 * dz, 6 + 9 * row + dz}, plot_x - 4, 0.12, true);
  }

  // Something more at a pipe, or on the ground of the plot.
  void clutter() {
    const double kind = random_.uniform(), quarter = 0.25 * random_.below(4);
    const Part bend = parts_.bends[random_.below(4)];
    if (kind < 0.75 && !runs_.empty()) {
      const Run& run = runs_[random_.below(static_cast<std::uint32_t>(runs_.size()))];
      const double along = random_.uniform() * run.length, turns = run.along_x ? 0.0 : 0.75;
      const glm::dvec3 at = run.from + (run.along_x ? glm::dvec3(along, 0, 0) : glm::dvec3(0, 0, along));
      const double radius = run.radius;
      if (kind < 0.2)
        put(parts_.valve, at, turns, glm::dvec3(radius));
      else if (kind < 0.45)
        put(parts_.flange, at, turns, glm::dvec3(radius));
      else
        put(bend, at, quarter, glm::dvec3(std::min(1.5, 8 * radius)));
      return;
    }
    const double x = random_.range(1, plot_x - 1), z = random_.range(1, plot_z - 1);
    if (kind < 0.85)
      put(bend, {x, random_.range(0.3, 5), z}, quarter);
    else if (kind < 0.92)
      put(parts_.cabinet, {x, 0, z}, quarter);
    else
      put(parts_.lamp, {x, 0, random_.chance(0.5) ? 0.8 : plot_z - 0.8}, quarter);
  }

  struct Run {
    glm::dvec3 from;
    double length, radius;
    bool along_x;
  };
  Layout& layout_;
  const PlantParts& parts_;
  glm::dvec2 corner_;
  std::uint32_t until_;
  Random random_;
  std::vector<Run> runs_;
};

}  // namespace

Scene generate_plant(const GenerateConfig& config) {
  Layout layout(config);
  const PlantParts parts(layout);
  if (config.objects == 1) {
    layout.place(parts.tank, place_at({0, 0, 0}, 0, {8, 12, 8}));
    return layout.build();
  }
  const PlotGrid grid(config.objects - 1, objects_per_plot, {plot_x, plot_z}, road);
  layout.place(parts.ground, place_at({0, 0, 0}, 0, {grid.size().x + 20, 1, grid.size().y + 20}));
  for (std::uint32_t i = 0; i < grid.count; ++i)
    PlotBuilder(layout, parts, grid.corner(i), 1 + grid.until(i), mix(config.seed, i + 1)).build();
  return layout.build();
}

}  // namespace sightline
