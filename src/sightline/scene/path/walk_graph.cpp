#include "sightline/scene/path/walk_graph.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>

namespace sightline {
namespace {

constexpr std::uint32_t nowhere = 0xFFFFFFFFu;

bool column_before(const glm::ivec3& a, const glm::ivec3& b) {
  if (a.z != b.z) return a.z < b.z;
  if (a.x != b.x) return a.x < b.x;
  return a.y < b.y;
}

}  // namespace

WalkGraph::WalkGraph(const Scene& scene, const FreeSpace& space, Gait gait, double eye_height) {
  if (gait == Gait::walk) find_walk_places(space, eye_height);
  if (gait == Gait::ground) find_ground_places(scene, space, eye_height);
  if (gait == Gait::fly) find_fly_places(space);
  std::sort(places_.begin(), places_.end(),
            [](const Place& a, const Place& b) { return column_before(a.cell, b.cell); });
  // Stairs and kerbs, but not furniture; a coarse grid sees a slope as steps of its own size.
  link(space, std::max(0.22 * eye_height, space.cell()), gait == Gait::fly);
  find_rooms(0.02 * eye_height);
  keep_largest_region(scene);
  price(gait == Gait::fly ? 6 : 8);
}

// Above every floor: at eye height, or lower where the ceiling is low.
void WalkGraph::find_walk_places(const FreeSpace& space, double eye_height) {
  const glm::ivec3 size = space.size();
  const double cell = space.cell();
  for (int z = 0; z < size.z; ++z)
    for (int x = 0; x < size.x; ++x)
      for (int y = 0; y + 1 < size.y; ++y) {
        const double floor = space.floor({x, y, z});
        if (!(floor > -1e30)) continue;
        if (!space.free(glm::ivec3(x, y + 1, z))) continue;
        int above = y + 1;
        while (above < size.y && space.free(glm::ivec3(x, above, z))) ++above;
        const bool covered = above < size.y;
        const double head_room = space.origin().y + above * cell - floor;
        if (covered && head_room < 0.5 * eye_height) continue;
        const double lowest = space.origin().y + (y + 1.1) * cell;
        const double height = covered ? std::min(eye_height, 0.65 * head_room) : eye_height;
        const double eye = std::max(lowest, floor + height);
        glm::dvec3 position = space.centre_of({x, y, z});
        position.y = eye;
        const glm::ivec3 at = space.cell_of(position);
        if (space.free(at)) places_.push_back({at, floor, position, 1, covered});
      }
}

void WalkGraph::find_ground_places(const Scene& scene, const FreeSpace& space, double eye_height) {
  const double ground = scene.bounds().lo.y;
  for (int z = 0; z < space.size().z; ++z)
    for (int x = 0; x < space.size().x; ++x) {
      glm::dvec3 position = space.centre_of({x, 0, z});
      position.y = ground + 0.5 * eye_height;
      if (!space.free(position)) continue;
      position.y = ground + eye_height;
      if (space.free(position)) places_.push_back({space.cell_of(position), ground, position, 1, false});
    }
}

void WalkGraph::find_fly_places(const FreeSpace& space) {
  for (int y = 0; y < space.size().y; ++y)
    for (int z = 0; z < space.size().z; ++z)
      for (int x = 0; x < space.size().x; ++x) {
        const glm::ivec3 cell(x, y, z);
        if (!space.free(cell)) continue;
        const glm::dvec3 position = space.centre_of(cell);
        places_.push_back({cell, position.y, position, 1, false});
      }
}

// Places in the eight neighbouring columns (for a flight also above and below) whose floors differ by at most `climb`.
// A diagonal must not cut a corner.
void WalkGraph::link(const FreeSpace& space, double climb, bool fly) {
  const glm::ivec3 size = space.size();
  std::vector<std::uint32_t> first(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.z) + 1, 0);
  const auto column = [&](int x, int z) {
    return static_cast<std::size_t>(z) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(x);
  };
  for (const Place& place : places_) ++first[column(place.cell.x, place.cell.z) + 1];
  for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
  link_starts_.assign(1, 0);
  links_.clear();
  for (const Place& place : places_) {
    for (int dz = -1; dz <= 1; ++dz)
      for (int dx = -1; dx <= 1; ++dx) {
        const int x = place.cell.x + dx, z = place.cell.z + dz;
        if (x < 0 || z < 0 || x >= size.x || z >= size.z || (dx == 0 && dz == 0 && !fly)) continue;
        for (std::uint32_t other = first[column(x, z)]; other < first[column(x, z) + 1]; ++other) {
          const int dy = places_[other].cell.y - place.cell.y;
          const bool near = fly ? std::abs(dx) + std::abs(dy) + std::abs(dz) == 1
                                : std::abs(places_[other].floor - place.floor) <= climb;
          const int top = std::max(places_[other].cell.y, place.cell.y);
          const bool cuts_corner =
              dx != 0 && dz != 0 &&
              (!space.free(glm::ivec3(x, top, place.cell.z)) || !space.free(glm::ivec3(place.cell.x, top, z)));
          if (near && !cuts_corner) links_.push_back(other);
        }
      }
    link_starts_.push_back(static_cast<std::uint32_t>(links_.size()));
  }
}

// A roof above and a flat floor below: rooms, but not the top of a bundle of pipes or the ground below a tree.
void WalkGraph::find_rooms(double unevenness) {
  for (std::uint32_t i = 0; i < places_.size(); ++i) {
    const auto links = links_of(i);
    const auto level = std::count_if(links.begin(), links.end(), [&](std::uint32_t other) {
      return std::abs(places_[other].floor - places_[i].floor) <= unevenness;
    });
    places_[i].in_room = places_[i].covered && level >= 5;
  }
}

WalkGraph::Regions WalkGraph::find_regions() const {
  Regions regions;
  regions.of_place.assign(places_.size(), nowhere);
  std::vector<std::uint32_t> stack;
  for (std::uint32_t start = 0; start < places_.size(); ++start) {
    if (regions.of_place[start] != nowhere) continue;
    const auto name = static_cast<std::uint32_t>(regions.sizes.size());
    regions.sizes.push_back(0);
    regions.weights.push_back(0);
    regions.of_place[start] = name;
    stack.push_back(start);
    while (!stack.empty()) {
      const std::uint32_t place = stack.back();
      stack.pop_back();
      ++regions.sizes[name];
      regions.weights[name] += places_[place].in_room ? 16 : 1;  // rooms rather than the lawn around the house
      for (const std::uint32_t other : links_of(place))
        if (regions.of_place[other] == nowhere) {
          regions.of_place[other] = name;
          stack.push_back(other);
        }
    }
  }
  return regions;
}

// A region lies within one closed object or outside of it altogether, so a few of its places tell.
bool WalkGraph::inside_solid(const Scene& scene, const Regions& regions, std::uint32_t region) const {
  constexpr std::uint32_t tests = 7;
  const std::uint32_t stride = regions.sizes[region] / tests + 1;
  std::uint32_t inside = 0, tested = 0, seen = 0;
  for (std::uint32_t i = 0; i < places_.size() && tested < tests; ++i)
    if (regions.of_place[i] == region && seen++ % stride == 0) {
      ++tested;
      inside += inside_closed_object(scene, places_[i].eye) ? 1 : 0;
    }
  return 2 * inside > tested;
}

void WalkGraph::keep_largest_region(const Scene& scene) {
  const Regions regions = find_regions();
  std::vector<std::uint32_t> order(regions.sizes.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return regions.weights[a] != regions.weights[b] ? regions.weights[a] > regions.weights[b] : a < b;
  });
  if (order.size() > 16) order.resize(16);  // smaller ones are not worth the search
  const auto best = std::find_if(order.begin(), order.end(),
                                 [&](std::uint32_t region) { return !inside_solid(scene, regions, region); });
  keep(regions, best == order.end() ? nowhere : *best);
}

void WalkGraph::keep(const Regions& regions, std::uint32_t region) {
  std::vector<std::uint32_t> renamed(places_.size(), nowhere), starts{0}, links;
  std::vector<Place> kept;
  for (std::uint32_t i = 0; i < places_.size(); ++i)
    if (regions.of_place[i] == region) {
      renamed[i] = static_cast<std::uint32_t>(kept.size());
      kept.push_back(places_[i]);
    }
  for (std::uint32_t i = 0; i < places_.size(); ++i) {
    if (renamed[i] == nowhere) continue;
    for (const std::uint32_t other : links_of(i)) links.push_back(renamed[other]);
    starts.push_back(static_cast<std::uint32_t>(links.size()));
  }
  places_ = std::move(kept);
  link_starts_ = std::move(starts);
  links_ = std::move(links);
  for (std::size_t i = 0; i < places_.size(); ++i)
    if (i == 0 || places_[i].cell.x != places_[i - 1].cell.x || places_[i].cell.z != places_[i - 1].cell.z) ++columns_;
}

// Places near the rim of the region cost more, up to four cells from it.
void WalkGraph::price(std::uint32_t all_around) {
  std::vector<int> distance(places_.size(), -1);
  std::vector<std::uint32_t> wave, next;
  for (std::uint32_t i = 0; i < places_.size(); ++i)
    if (links_of(i).size() < all_around) {
      distance[i] = 0;
      wave.push_back(i);
    }
  for (int d = 1; d <= 4; ++d, wave.swap(next), next.clear())
    for (const std::uint32_t i : wave)
      for (const std::uint32_t other : links_of(i))
        if (distance[other] < 0) {
          distance[other] = d;
          next.push_back(other);
        }
  constexpr float costs[] = {8.0f, 4.0f, 2.0f, 1.4f, 1.1f};
  for (std::uint32_t i = 0; i < places_.size(); ++i) places_[i].cost = distance[i] < 0 ? 1.0f : costs[distance[i]];
}

std::vector<std::uint32_t> WalkGraph::goals() const {
  std::vector<std::uint32_t> in_rooms, all;
  for (std::uint32_t i = 0; i < places_.size(); ++i) {
    all.push_back(i);
    if (places_[i].in_room) in_rooms.push_back(i);
  }
  return 4 * in_rooms.size() > all.size() ? in_rooms : all;
}

double WalkGraph::extent() const {
  Aabb box;
  for (const Place& place : places_) box.extend(glm::vec3(place.eye.x, 0, place.eye.z));
  if (box.empty()) return 0.0;
  const glm::dvec3 size(box.extent());
  return std::sqrt(glm::dot(size, size));
}

std::vector<glm::dvec3> WalkGraph::way(std::uint32_t from, std::uint32_t to) const {
  std::vector<double> cost(places_.size(), std::numeric_limits<double>::infinity());
  std::vector<std::uint32_t> before(places_.size(), nowhere);
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  cost[from] = 0;
  open.push({0.0, from});
  while (!open.empty()) {
    const auto [paid, place] = open.top();
    open.pop();
    if (place == to) break;
    if (paid > cost[place]) continue;
    for (const std::uint32_t other : links_of(place)) {
      const glm::dvec3 step = places_[other].eye - places_[place].eye;
      const double sum = paid + std::sqrt(glm::dot(step, step)) * places_[other].cost;
      if (sum >= cost[other]) continue;
      cost[other] = sum;
      before[other] = place;
      open.push({sum, other});
    }
  }
  std::vector<glm::dvec3> points;
  for (std::uint32_t place = to; place != nowhere; place = before[place]) points.push_back(places_[place].eye);
  std::reverse(points.begin(), points.end());
  return points;
}

}  // namespace sightline
