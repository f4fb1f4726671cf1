#include "sightline/cull/occlusion_stage.hpp"

#include <algorithm>
#include <cmath>

#include "sightline/parallel/parallel.hpp"
#include "sightline/scene/input_error.hpp"

namespace sightline {
namespace {

/// A fixed shuffle: the same for every run, machine and number of threads (Steele, Lea, Flood 2014).
std::uint64_t scramble(std::uint64_t v) {
  v += 0x9E3779B97F4A7C15ull;
  v = (v ^ (v >> 30)) * 0xBF58476D1CE4E5B9ull;
  v = (v ^ (v >> 27)) * 0x94D049BB133111EBull;
  return v ^ (v >> 31);
}

double distance_to(const Aabb& box, const View& view, const glm::dvec3& direction) {
  if (view.projection == Projection::orthographic) {
    const glm::dvec3 centre(box.centre()), half = 0.5 * glm::dvec3(box.extent());
    return glm::dot(direction, centre - view.eye) - glm::dot(glm::abs(direction), half);
  }
  const glm::dvec3 out =
      glm::max(glm::max(glm::dvec3(box.lo) - view.eye, view.eye - glm::dvec3(box.hi)), glm::dvec3(0.0));
  return glm::length(out);
}

}  // namespace

void read_stage(ParameterReader& parameters, OcclusionStageConfig& config) {
  std::string order = "sorted";
  parameters.read("order", order);
  if (order == "sorted")
    config.order = Order::sorted;
  else if (order == "random")
    config.order = Order::random;
  else if (order == "worst")
    config.order = Order::worst;
  else
    throw InputError("", "order", "must be sorted, random or worst, not '" + order + "'");
  parameters.read("resolution", config.resolution, 1.0 / 16, 2.0);
  parameters.read("triangles", config.triangles, 0, 1 << 30);
  parameters.read("min_size", config.min_size, 0.0, 1e6);
  parameters.read("scalar", config.scalar);
  parameters.read("tight", config.tight, 1.0, 100.0);
}

OcclusionStage::OcclusionStage(const IndexedScene& scene, const OcclusionStageConfig& config)
    : scene_(scene.scene),
      bvh_(scene.bvh),
      config_(config),
      buffer_(config.scalar),
      meshes_(scene.scene.meshes().size()) {
  parallel_blocks(meshes_.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Mesh& mesh = scene_.meshes()[i];
      if (mesh.triangles.size() <= static_cast<std::size_t>(config_.triangles))
        meshes_[i] = make_occluder(mesh.positions, mesh.triangles);
    }
  });
  if (config_.tight > 1.0) tight_ = OccludeeBounds(scene_, {.sigma = config_.tight});
}

void OcclusionStage::follow_scene() {
  if (!tight_.empty()) tight_.follow(scene_);
}

bool OcclusionStage::project_parts(ObjectId id) {
  if (tight_.empty() || tight_.boxes(id).size() <= 1) return false;
  parts_.clear();
  for (const Aabb& part : tight_.boxes(id)) {
    const BoxFootprint footprint = projector_.project(part);
    if (footprint.place == BoxPlace::everywhere) return false;
    if (footprint.place == BoxPlace::rectangle) parts_.push_back({part, footprint});
  }
  return true;
}

void OcclusionStage::begin(const View& view, const VisibleSet& candidates, Counters& counters) {
  const auto scaled = [&](int pixels) {
    return std::clamp(static_cast<int>(std::lround(pixels * config_.resolution)), 1, 16384);
  };
  buffer_.begin(view, scaled(view.width), scaled(view.height));
  budget_ = config_.triangles;
  objects_.clear();
  if (bvh_.nodes.empty()) return;
  collect(view_frustum(view, reach(scene_.bounds())), candidates, counters);
  projector_ = BoxProjector(view, width(), height());
  const glm::dvec3 direction = view_direction(view);
  for (StagedObject& object : objects_) {
    const Aabb& box = scene_.objects()[object.id].bounds;
    object.footprint = projector_.project(box);
    object.distance = distance_to(box, view, direction);
  }
  std::erase_if(objects_, [](const StagedObject& object) { return object.footprint.place == BoxPlace::unseen; });
  sort();
}

void OcclusionStage::collect(const Frustum& frustum, const VisibleSet& candidates, Counters& counters) {
  const bool all = candidates.is_all();
  stack_.assign(1, 0);
  while (!stack_.empty()) {
    const BvhNode& node = bvh_.nodes[stack_.back()];
    stack_.pop_back();
    ++counters.nodes_visited;
    ++counters.boxes_tested;
    if (classify(frustum, node.bounds) == Containment::outside) continue;
    if (!node.leaf()) {
      stack_.push_back(node.first + 1);
      stack_.push_back(node.first);
      continue;
    }
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const ObjectId id = bvh_.items[i];
      const Aabb& box = scene_.objects()[id].bounds;
      if (box.empty() || (!all && !candidates.contains(id))) continue;
      ++counters.boxes_tested;
      if (classify(frustum, box) != Containment::outside) objects_.push_back({id, 0.0, {}});
    }
  }
}

void OcclusionStage::sort() {
  const auto before = [](const StagedObject& a, const StagedObject& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.id < b.id;
  };
  if (config_.order == Order::random)
    std::sort(objects_.begin(), objects_.end(), [](const StagedObject& a, const StagedObject& b) {
      const std::uint64_t ka = scramble(a.id), kb = scramble(b.id);
      return ka != kb ? ka < kb : a.id < b.id;
    });
  else if (config_.order == Order::sorted)
    std::sort(objects_.begin(), objects_.end(), before);
  else
    std::sort(objects_.begin(), objects_.end(),
              [&](const StagedObject& a, const StagedObject& b) { return before(b, a); });
}

bool OcclusionStage::reserve(const StagedObject& staged) {
  const Object& object = scene_.objects()[staged.id];
  const auto triangles = static_cast<std::int64_t>(scene_.meshes()[object.mesh].triangles.size());
  const BoxFootprint& f = staged.footprint;
  if (!object.opaque || triangles == 0 || triangles > budget_) return false;
  if (std::min(f.x1 - f.x0, f.y1 - f.y0) < config_.min_size) return false;
  budget_ -= triangles;
  return true;
}

void OcclusionStage::draw_reserved(const StagedObject& staged) {
  const Object& object = scene_.objects()[staged.id];
  buffer_.add_occluder(meshes_[object.mesh], object.transform);
}

bool OcclusionStage::draw(const StagedObject& staged) {
  if (!reserve(staged)) return false;
  draw_reserved(staged);
  return true;
}

void OcclusionStage::end(Counters& counters) const {
  counters.occluders += buffer_.counts().occluders;
  counters.occluder_triangles += buffer_.counts().occluder_triangles;
}

}  // namespace sightline
