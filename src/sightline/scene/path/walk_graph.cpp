#include "sightline/scene/path/walk_graph.hpp"

#include <algorithm>
#include <cmath>
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
  link_ends_.clear();
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
    link_ends_.push_back(static_cast<std::uint32_t>(links_.size()));
  }
}

void WalkGraph::keep_largest_region(const Scene& scene) {
  std::vector<std::uint32_t> region(places_.size(), nowhere), sizes, weights, stack;
  for (std::uint32_t start = 0; start < places_.size(); ++start) {
    if (region[start] != nowhere) continue;
    const auto name = static_cast<std::uint32_t>(sizes.size());
    sizes.push_back(0);
    weights.push_back(0);
    region[start] = name;
    stack.push_back(start);
    while (!stack.empty()) {
      const std::uint32_t place = stack.back();
      stack.pop_back();
      ++sizes[name];
      weights[name] += places_[place].covered ? 16 : 1;  // rooms rather than the lawn around the house
      for (std::uint32_t k = place == 0 ? 0 : link_ends_[place - 1]; k < link_ends_[place]; ++k)
        if (region[links_[k]] == nowhere) {
          region[links_[k]] = name;
          stack.push_back(links_[k]);
        }
    }
  }
  // A region is within one closed object or outside of it altogether, so a few of its places tell.
  std::uint32_t best = nowhere;
  std::vector<std::uint32_t> order(sizes.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return weights[a] > weights[b]; });
  for (std::size_t k = 0; k < std::min<std::size_t>(order.size(), 16) && best == nowhere; ++k) {
    int inside = 0, tested = 0;
    std::uint32_t seen = 0;
    for (std::uint32_t i = 0; i < places_.size() && tested < 7; ++i)
      if (region[i] == order[k] && seen++ % (sizes[order[k]] / 7 + 1) == 0) {
        ++tested;
        inside += inside_closed_object(scene, places_[i].eye) ? 1 : 0;
      }
    if (2 * inside <= tested) best = order[k];
  }
  std::vector<std::uint32_t> renamed(places_.size(), nowhere);
  std::vector<Place> kept;
  for (std::uint32_t i = 0; i < places_.size(); ++i)
    if (best != nowhere && region[i] == best) {
      renamed[i] = static_cast<std::uint32_t>(kept.size());
      kept.push_back(places_[i]);
    }
  std::vector<std::uint32_t> ends, links;
  for (std::uint32_t i = 0; i < places_.size(); ++i) {
    if (renamed[i] == nowhere) continue;
    for (std::uint32_t k = i == 0 ? 0 : link_ends_[i - 1]; k < link_ends_[i]; ++k) links.push_back(renamed[links_[k]]);
    ends.push_back(static_cast<std::uint32_t>(links.size()));
  }
  places_ = std::move(kept);
  link_ends_ = std::move(ends);
  links_ = std::move(links);
  for (std::size_t i = 0; i < places_.size(); ++i)
    columns_ += i == 0 || places_[i].cell.x != places_[i - 1].cell.x || places_[i].cell.z != places_[i - 1].cell.z;
}

// Places near the rim of the region cost more, up to four cells from it.
void WalkGraph::price(std::uint32_t all_around) {
  std::vector<int> distance(places_.size(), -1);
  std::vector<std::uint32_t> wave, next;
  for (std::uint32_t i = 0; i < places_.size(); ++i)
    if (link_ends_[i] - (i == 0 ? 0 : link_ends_[i - 1]) < all_around) {
      distance[i] = 0;
      wave.push_back(i);
    }
  for (int d = 1; d <= 4; ++d, wave.swap(next), next.clear())
    for (const std::uint32_t i : wave)
      for (std::uint32_t k = i == 0 ? 0 : link_ends_[i - 1]; k < link_ends_[i]; ++k)
        if (distance[links_[k]] < 0) {
          distance[links_[k]] = d;
          next.push_back(links_[k]);
        }
  constexpr float costs[] = {8.0f, 4.0f, 2.0f, 1.4f, 1.1f};
  for (std::uint32_t i = 0; i < places_.size(); ++i) places_[i].cost = distance[i] < 0 ? 1.0f : costs[distance[i]];
}

std::vector<std::uint32_t> WalkGraph::goals() const {
  std::vector<std::uint32_t> covered, all;
  for (std::uint32_t i = 0; i < places_.size(); ++i) {
    all.push_back(i);
    if (places_[i].covered) covered.push_back(i);
  }
  return 4 * covered.size() > all.size() ? covered : all;
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
    for (std::uint32_t k = place == 0 ? 0 : link_ends_[place - 1]; k < link_ends_[place]; ++k) {
      const std::uint32_t other = links_[k];
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
