// The places of a free space where an eye may be, and ways between them: shortest paths that keep away from walls
// (Dijkstra 1959).
#pragma once

#include "sightline/scene/generate/random.hpp"
#include "sightline/scene/path/free_space.hpp"

namespace sightline {

/// How eyes may move.
enum class Gait {
  walk,    // at eye height above floors
  ground,  // at eye height above the lowest level of the scene, as if it had a ground
  fly      // anywhere
};

class WalkGraph {
 public:
  WalkGraph() = default;
  /// Keeps the largest connected set of places that are not inside of closed objects. `eye_height` in metres.
  WalkGraph(const Scene& scene, const FreeSpace& space, Gait gait, double eye_height);

  /// How many places are left; 0 if there is no way.
  [[nodiscard]] std::size_t size() const { return places_.size(); }
  /// How many columns of the grid they stand in, of how many.
  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] const glm::dvec3& position(std::size_t place) const { return places_[place].eye; }
  /// Places worth going to: those in rooms where there are many of them, else all.
  [[nodiscard]] std::vector<std::uint32_t> goals() const;
  /// Horizontal diagonal of the region, metres.
  [[nodiscard]] double extent() const;
  /// The way between two places as positions, both ends included.
  [[nodiscard]] std::vector<glm::dvec3> way(std::uint32_t from, std::uint32_t to) const;

 private:
  struct Place {
    glm::ivec3 cell;
    double floor;  // for a walk, the height of the floor; else of the eye
    glm::dvec3 eye;
    float cost;    // per metre, 1 in the open
    bool covered;  // something is above
    bool in_room = false;
  };
  struct Regions {
    std::vector<std::uint32_t> of_place;        // the region of every place
    std::vector<std::uint32_t> sizes, weights;  // of every region
  };
  [[nodiscard]] std::span<const std::uint32_t> links_of(std::uint32_t place) const {
    return std::span(links_).subspan(link_starts_[place], link_starts_[place + 1] - link_starts_[place]);
  }
  void find_walk_places(const FreeSpace& space, double eye_height);
  void find_ground_places(const Scene& scene, const FreeSpace& space, double eye_height);
  void find_fly_places(const FreeSpace& space);
  void find_rooms(double unevenness);
  void link(const FreeSpace& space, double climb, bool fly);
  [[nodiscard]] Regions find_regions() const;
  [[nodiscard]] bool inside_solid(const Scene& scene, const Regions& regions, std::uint32_t region) const;
  void keep_largest_region(const Scene& scene);
  void keep(const Regions& regions, std::uint32_t region);
  void price(std::uint32_t all_around);

  std::vector<Place> places_;
  std::vector<std::uint32_t> link_starts_;  // links of place i are links_[link_starts_[i] .. link_starts_[i + 1])
  std::vector<std::uint32_t> links_;
  std::size_t columns_ = 0;
};

}  // namespace sightline
