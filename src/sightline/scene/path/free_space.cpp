#include "sightline/scene/path/free_space.hpp"

#include <algorithm>
#include <cmath>

#include "sightline/scene/generate/random.hpp"

namespace sightline {
namespace {

double largest(const glm::dvec3& v) { return std::max({v.x, v.y, v.z}); }

Aabb grown(const Aabb& box, double side, double top) {
  const glm::vec3 low(side, side, side), high(side, top, side);
  return {box.lo - low, box.hi + high};
}

// Of some objects of ordinary size, the one with the most neighbours in a window of `size` around it: its place.
glm::dvec3 busy_place(const Scene& scene, const glm::dvec3& size, std::uint64_t seed) {
  const std::span<const Object> objects = scene.objects();
  Random random(seed, 77);
  glm::dvec3 best = scene.bounds().centre();
  std::size_t best_count = 0;
  for (int trial = 0; trial < 12; ++trial) {
    const Aabb& pivot = objects[random.below(static_cast<std::uint32_t>(objects.size()))].bounds;
    if (pivot.empty() || largest(pivot.extent()) > 0.5 * largest(size)) continue;
    // More air above than below: windows of tall scenes stand on the ground.
    const glm::dvec3 centre = glm::dvec3(pivot.centre()) * glm::dvec3(1, 0, 1) +
                              glm::dvec3(0, static_cast<double>(pivot.lo.y) + 0.3 * size.y, 0);
    const Aabb window{glm::vec3(centre - 0.5 * size), glm::vec3(centre + 0.5 * size)};
    std::size_t count = 0;
    const std::size_t stride = 1 + objects.size() / 100'000;
    for (std::size_t i = 0; i < objects.size(); i += stride) count += window.overlaps(objects[i].bounds) ? 1 : 0;
    if (count > best_count) {
      best_count = count;
      best = centre;
    }
  }
  return best;
}

// Does the upward ray from p cross the triangle? Edges count once for triangles that share them (half-open in
// projection).
bool crosses_upward(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const auto side = [&](const glm::dvec3& u, const glm::dvec3& v) {
    const bool swapped = u.x > v.x || (u.x == v.x && u.z > v.z);
    const glm::dvec3 &s = swapped ? v : u, &t = swapped ? u : v;
    const double cross = (t.x - s.x) * (p.z - s.z) - (t.z - s.z) * (p.x - s.x);
    return (cross >= 0) != swapped;
  };
  const bool ab = side(a, b), bc = side(b, c), ca = side(c, a);
  if (ab != bc || bc != ca) return false;
  const glm::dvec3 n = glm::cross(b - a, c - a);
  if (n.y == 0) return false;
  return a.y - ((p.x - a.x) * n.x + (p.z - a.z) * n.z) / n.y > p.y;
}

}  // namespace

FreeSpace::FreeSpace(const Scene& scene, const FreeSpaceConfig& config) {
  choose_window(scene, config);
  const auto cells =
      static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) * static_cast<std::size_t>(size_.z);
  surface_.assign(cells, 0);
  floor_.assign(cells, -std::numeric_limits<float>::infinity());
  add_objects(scene, config);
}

void FreeSpace::choose_window(const Scene& scene, const FreeSpaceConfig& config) {
  const Aabb all = grown(scene.bounds(), config.margin_side, config.margin_top);
  const glm::dvec3 extent(all.extent());
  const auto budget = static_cast<double>(config.cells);
  // Flat extents still take one cell, so the cube root alone would give too many.
  cell_ = std::max({std::cbrt(extent.x * extent.y * extent.z / budget), largest(extent) / 2000, config.finest, 1e-9});
  origin_ = glm::dvec3(all.lo);
  glm::dvec3 window = extent;
  if (config.coarsest > 0 && cell_ > config.coarsest) {
    cell_ = config.coarsest;
    window.y = std::min(extent.y, 48 * cell_);
    const double across = std::sqrt(budget * cell_ * cell_ * cell_ / window.y);
    window.x = std::min(extent.x, across);
    window.z = std::min(extent.z, across * across / window.x);
    const glm::dvec3 centre = busy_place(scene, window, config.seed);
    origin_ = glm::clamp(centre - 0.5 * window, glm::dvec3(all.lo), glm::dvec3(all.hi) - window);
  }
  size_ = glm::max(glm::ivec3(glm::ceil(window / cell_)), glm::ivec3(1));
}

void FreeSpace::add_box(const Aabb& box) {
  const glm::ivec3 low = glm::max(cell_of(box.lo), glm::ivec3(0));
  const glm::ivec3 high = glm::min(cell_of(box.hi), size_ - 1);
  for (int y = low.y; y <= high.y; ++y)
    for (int z = low.z; z <= high.z; ++z)
      for (int x = low.x; x <= high.x; ++x) surface_[index({x, y, z})] = 1;
}

// Halves the triangle until its bounds span two cells at most.
void FreeSpace::add_triangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, bool faces_up) {
  const glm::dvec3 low = glm::min(a, glm::min(b, c)), high = glm::max(a, glm::max(b, c));
  const glm::ivec3 first = cell_of(low), last = cell_of(high);
  if (glm::any(glm::greaterThan(first, size_ - 1)) || glm::any(glm::lessThan(last, glm::ivec3(0)))) return;
  if (glm::any(glm::greaterThan(last - first, glm::ivec3(1)))) {
    const double ab = glm::dot(b - a, b - a), bc = glm::dot(c - b, c - b), ca = glm::dot(a - c, a - c);
    if (ab >= bc && ab >= ca) {
      const glm::dvec3 m = 0.5 * (a + b);
      add_triangle(a, m, c, faces_up);
      add_triangle(m, b, c, faces_up);
    } else if (bc >= ca) {
      const glm::dvec3 m = 0.5 * (b + c);
      add_triangle(a, b, m, faces_up);
      add_triangle(a, m, c, faces_up);
    } else {
      const glm::dvec3 m = 0.5 * (c + a);
      add_triangle(a, b, m, faces_up);
      add_triangle(m, b, c, faces_up);
    }
    return;
  }
  add_box({glm::vec3(low), glm::vec3(high)});
  if (!faces_up) return;
  for (int z = std::max(first.z, 0); z <= std::min(last.z, size_.z - 1); ++z)
    for (int x = std::max(first.x, 0); x <= std::min(last.x, size_.x - 1); ++x) {
      const glm::ivec3 cell(x, std::clamp(last.y, 0, size_.y - 1), z);
      if (cell.y == last.y) floor_[index(cell)] = std::max(floor_[index(cell)], static_cast<float>(high.y));
    }
}

void FreeSpace::add_objects(const Scene& scene, const FreeSpaceConfig& config) {
  const std::span<const Object> objects = scene.objects();
  const Aabb window{glm::vec3(origin_), glm::vec3(origin_ + glm::dvec3(size_) * cell_)};
  std::vector<ObjectId> large;
  for (ObjectId id = 0; id < objects.size(); ++id) {
    const Aabb& box = objects[id].bounds;
    if (box.empty() || !window.overlaps(box)) continue;
    if (largest(box.extent()) <= 1.5 * cell_)
      add_box(box);
    else
      large.push_back(id);
  }
  std::sort(large.begin(), large.end(), [&](ObjectId a, ObjectId b) {
    const double sa = largest(objects[a].bounds.extent()), sb = largest(objects[b].bounds.extent());
    return sa != sb ? sa > sb : a < b;
  });
  std::uint64_t triangles = 0;
  std::vector<glm::dvec3> world;
  for (const ObjectId id : large) {
    const Object& object = objects[id];
    const Mesh& mesh = scene.mesh_of(id);
    triangles += mesh.triangles.size();
    if (triangles > config.triangles) {
      add_box(object.bounds);
      continue;
    }
    world.clear();
    for (const glm::vec3& p : mesh.positions) world.emplace_back(transform_point(object.transform, p));
    const double sign = determinant(object.transform) < 0 ? -1.0 : 1.0;
    for (const glm::uvec3& t : mesh.triangles) {
      const glm::dvec3 &a = world[t.x], &b = world[t.y], &c = world[t.z];
      const glm::dvec3 normal = sign * glm::cross(b - a, c - a);
      add_triangle(a, b, c, normal.y > 0.7 * std::sqrt(glm::dot(normal, normal)));
    }
  }
}

bool inside_closed_object(const Scene& scene, const glm::dvec3& point) {
  for (ObjectId id = 0; id < scene.objects().size(); ++id) {
    const Object& object = scene.objects()[id];
    const Mesh& mesh = scene.mesh_of(id);
    if (!mesh.closed || !object.bounds.contains(glm::vec3(point))) continue;
    bool inside = false;
    for (const glm::uvec3& t : mesh.triangles)
      inside ^= crosses_upward(point, transform_point(object.transform, mesh.positions[t.x]),
                               transform_point(object.transform, mesh.positions[t.y]),
                               transform_point(object.transform, mesh.positions[t.z]));
    if (inside) return true;
  }
  return false;
}

}  // namespace sightline
