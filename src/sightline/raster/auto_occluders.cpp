#include "sightline/raster/auto_occluders.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sightline/parallel/parallel.hpp"
#include "sightline/raster/coplanar_patches.hpp"
#include "sightline/raster/solid_boxes.hpp"

namespace sightline {
namespace {

/// Something that can be bought: a patch of a mesh, or all its boxes.
struct Offer {
  std::uint32_t mesh;
  std::uint32_t patch;  // or `boxes`
  double density;       // mean projected area for each triangle
  std::uint64_t cost;   // triangles over all instances
};
constexpr std::uint32_t boxes = 0xFFFFFFFFu;

struct Use {
  std::uint64_t count = 0;
  double scale_squared = 0;  // summed over the instances
};

std::vector<Use> uses_of(const Scene& scene) {
  std::vector<Use> uses(scene.meshes().size());
  for (const Object& object : scene.objects()) {
    if (!object.opaque) continue;
    Use& use = uses[object.mesh];
    ++use.count;
    use.scale_squared += std::pow(std::abs(static_cast<double>(determinant(object.transform))), 2.0 / 3.0);
  }
  return uses;
}

double box_area(const Aabb& box) { return 2 * static_cast<double>(box.half_area()); }

void add_box(const Aabb& box, Mesh& mesh) {
  constexpr std::uint32_t faces[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                          {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (int i = 0; i < 8; ++i) mesh.positions.push_back(box.corner(i));
  for (const auto& face : faces) mesh.triangles.emplace_back(first + face[0], first + face[1], first + face[2]);
}

/// Large patches hide more than many small ones of the same area, whose borders take back a pixel each.
double value_of(double area) { return area * std::sqrt(area); }

struct Parts {
  std::vector<Patch> patches;
  std::vector<Aabb> solid;
};

class Buyer {
 public:
  Buyer(std::uint64_t budget, std::vector<Offer> offers) : left_(budget), offers_(std::move(offers)) {
    std::sort(offers_.begin(), offers_.end(), [](const Offer& a, const Offer& b) {
      if (a.density != b.density) return a.density > b.density;
      return a.mesh != b.mesh ? a.mesh < b.mesh : a.patch < b.patch;
    });
  }
  template <class F>
  void buy(F&& take) {
    for (const Offer& offer : offers_) {
      if (offer.cost > left_ || !(offer.density > 0)) continue;
      left_ -= offer.cost;
      take(offer);
    }
  }

 private:
  std::uint64_t left_;
  std::vector<Offer> offers_;
};

std::uint64_t budget_of(const Scene& scene, const AutoOccluderConfig& config) {
  if (config.budget > 0) return config.budget;
  return static_cast<std::uint64_t>(config.share * static_cast<double>(scene.triangle_count()));
}

void compact(Mesh& mesh, const std::vector<glm::vec3>& positions) {
  std::vector<std::uint32_t> renamed(positions.size(), 0xFFFFFFFFu);
  for (glm::uvec3& t : mesh.triangles)
    for (int i = 0; i < 3; ++i) {
      std::uint32_t& name = renamed[t[i]];
      if (name == 0xFFFFFFFFu) {
        name = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.push_back(positions[t[i]]);
      }
      t[i] = name;
    }
}

}  // namespace

namespace {

double mean_scale(const Use& use) { return use.count == 0 ? 0.0 : use.scale_squared / static_cast<double>(use.count); }

void offer_patches(std::uint32_t m, const Parts& parts, const Use& use, double share, std::vector<Offer>& offers) {
  for (std::uint32_t p = 0; p < parts.patches.size(); ++p) {
    const Patch& patch = parts.patches[p];
    const double value = share * value_of(0.5 * patch.area * mean_scale(use));
    offers.push_back({m, p, value / static_cast<double>(patch.triangles.size()), patch.triangles.size() * use.count});
  }
}

/// The density of the last patch that the budget would buy if there were no boxes; 0 if it would buy all.
double last_density(const std::vector<Parts>& parts, const std::vector<Use>& uses, std::uint64_t budget) {
  std::vector<Offer> offers;
  std::uint64_t total = 0;
  for (std::uint32_t m = 0; m < parts.size(); ++m) offer_patches(m, parts[m], uses[m], 1.0, offers);
  for (const Offer& offer : offers) total += offer.cost;
  if (total <= budget) return 0;
  double last = std::numeric_limits<double>::infinity();
  Buyer(budget, std::move(offers)).buy([&](const Offer& offer) { last = std::min(last, offer.density); });
  return std::isfinite(last) ? last : 0;
}

/// Boxes inside the meshes for which they can be worth it: closed, with many triangles, and large enough.
void find_solids(const Scene& scene, const std::vector<Use>& uses, double least_density, int cells,
                 std::vector<Parts>& parts) {
  std::vector<std::uint32_t> wanted;
  for (std::uint32_t m = 0; m < parts.size(); ++m) {
    const Mesh& mesh = scene.meshes()[m];
    std::size_t triangles = 0;
    for (const Patch& patch : parts[m].patches) triangles += patch.triangles.size();
    const double most = value_of(0.25 * box_area(mesh.bounds) * mean_scale(uses[m])) / 12;
    if (uses[m].count > 0 && mesh.closed && triangles > 24 && most > least_density) wanted.push_back(m);
  }
  parallel_blocks(wanted.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      parts[wanted[i]].solid = solid_boxes(scene.meshes()[wanted[i]], {.cells = cells, .boxes = 6, .gain = 0.05});
  });
}

}  // namespace

AutoOccluders make_auto_occluders(const Scene& scene, const AutoOccluderConfig& config) {
  const std::vector<Use> uses = uses_of(scene);
  const std::uint64_t budget = budget_of(scene, config);
  std::vector<Parts> parts(uses.size());
  parallel_blocks(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t m = begin; m < end; ++m)
      if (uses[m].count > 0)
        parts[m].patches = coplanar_patches(scene.meshes()[m].positions, scene.meshes()[m].triangles);
  });
  if (config.solids) find_solids(scene, uses, last_density(parts, uses, budget), config.cells, parts);

  std::vector<Offer> offers;
  for (std::uint32_t m = 0; m < parts.size(); ++m) {
    double solid = 0, surface = 0;
    for (const Aabb& box : parts[m].solid) solid = std::max(solid, box_area(box));
    for (const Patch& patch : parts[m].patches) surface += patch.area;
    if (solid > 0) {
      const std::size_t cost = 12 * parts[m].solid.size();
      const double value = value_of(0.25 * solid * mean_scale(uses[m]));
      offers.push_back({m, boxes, value / static_cast<double>(cost), cost * uses[m].count});
    }
    // What the boxes hide the surface need not hide again.
    offer_patches(m, parts[m], uses[m], std::clamp(1 - solid / std::max(surface, 1e-300), 0.05, 1.0), offers);
  }

  AutoOccluders result;
  result.meshes.resize(parts.size());
  Buyer(budget, std::move(offers)).buy([&](const Offer& offer) {
    AutoOccluder& occluder = result.meshes[offer.mesh];
    const Parts& from = parts[offer.mesh];
    if (offer.patch == boxes)
      for (const Aabb& box : from.solid) add_box(box, occluder.solid);
    else
      for (const glm::uvec3& t : from.patches[offer.patch].triangles) occluder.surface.triangles.push_back(t);
    (offer.patch == boxes ? result.solid_triangles : result.surface_triangles) += offer.cost;
    result.triangles += offer.cost;
  });
  for (std::size_t m = 0; m < parts.size(); ++m) compact(result.meshes[m].surface, scene.meshes()[m].positions);
  return result;
}

Mesh make_scene_occluder(const Scene& scene, const AutoOccluderConfig& config) {
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (const Object& object : scene.objects()) {
    if (!object.opaque) continue;
    const Mesh& mesh = scene.meshes()[object.mesh];
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (const glm::vec3& p : mesh.positions) positions.push_back(transform_point(object.transform, p));
    for (const glm::uvec3& t : mesh.triangles) triangles.push_back(t + first);
  }
  const std::vector<Patch> patches = coplanar_patches(positions, triangles);
  std::vector<Offer> offers;
  for (std::uint32_t p = 0; p < patches.size(); ++p)
    offers.push_back({0, p, value_of(0.5 * patches[p].area) / static_cast<double>(patches[p].triangles.size()),
                      patches[p].triangles.size()});
  Mesh result;
  Buyer(budget_of(scene, config), std::move(offers)).buy([&](const Offer& offer) {
    for (const glm::uvec3& t : patches[offer.patch].triangles) result.triangles.push_back(t);
  });
  compact(result, positions);
  return result;
}

}  // namespace sightline
