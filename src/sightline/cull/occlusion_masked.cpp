#include "sightline/cull/occlusion_masked.hpp"

#include <algorithm>
#include <cmath>

#include "sightline/parallel/parallel.hpp"
#include "sightline/raster/auto_occluders.hpp"
#include "sightline/raster/occlusion_buffer.hpp"
#include "sightline/scene/input_error.hpp"
#include "sightline/scene/occludee_bounds.hpp"

namespace sightline {
namespace {

class OcclusionMasked final : public Culler {
 public:
  OcclusionMasked(const IndexedScene& scene, const OcclusionMaskedConfig& config)
      : scene_(scene.scene),
        bvh_(scene.bvh),
        config_(config),
        buffer_(config.scalar),
        occluders_(config.occluders ? config.occluders : occluders_of(scene.scene, config)) {
    if (config.tight > 1.0) tight_ = OccludeeBounds(scene_, {.sigma = config.tight});
  }

  /// Places are read from the scene in every frame; only tight bounds are kept.
  bool follow_scene() override {
    if (!tight_.empty()) tight_.follow(scene_);
    return true;
  }

  [[nodiscard]] Promise promise(Promise of_row) const override {
    return config_.centres ? Promise::conservative : of_row;
  }

  void cull(const View& view, const VisibleSet& candidates, VisibleSet& visible, Counters& counters) override {
    visible.reset(candidates.universe());
    if (bvh_.nodes.empty()) return;
    frustum_ = view_frustum(view, reach(scene_.bounds()));
    find_occluders(view, candidates, counters);
    draw_occluders(view, counters);
    collect(view, candidates, visible, counters);
  }

 private:
  struct Visit {
    std::uint32_t node, planes;
  };
  struct Choice {
    ObjectId id;
    float value;
  };

  static std::shared_ptr<const OccluderSet> occluders_of(const Scene& scene, const OcclusionMaskedConfig& config) {
    return config.automatic ? automatic_occluders(scene, config) : own_occluders(scene, config);
  }

  static std::shared_ptr<const OccluderSet> automatic_occluders(const Scene& scene,
                                                                const OcclusionMaskedConfig& config) {
    AutoOccluderConfig made;
    made.budget = static_cast<std::uint64_t>(config.auto_budget);
    const AutoOccluders automatic = make_auto_occluders(scene, made);
    auto set = std::make_shared<OccluderSet>();
    for (const AutoOccluder& occluder : automatic.meshes) {
      set->by_mesh.push_back(make_occluder(occluder.surface.positions, occluder.surface.triangles));
      set->solids.push_back(make_occluder(occluder.solid.positions, occluder.solid.triangles));
    }
    return set;
  }

  /// What stands for a mesh: triangles of its occluder, boxes inside of it included.
  [[nodiscard]] std::uint32_t triangles_of(MeshId mesh) const {
    return occluders_->by_mesh[mesh].triangle_count +
           (occluders_->solids.empty() ? 0 : occluders_->solids[mesh].triangle_count);
  }

  /// Boxes inside a mesh hide only where its whole surface counts: none of it before the near plane.
  static bool behind_near(const Aabb& box, const View& view) {
    const glm::dvec3 direction = view_direction(view), lo(box.lo), hi(box.hi);
    const double nearest =
        glm::dot(direction, 0.5 * (lo + hi) - view.eye) - glm::dot(glm::abs(direction), 0.5 * (hi - lo));
    return nearest > view.near + 1e-6 * (glm::length(lo) + glm::length(hi) + glm::length(view.eye));
  }

  /// Every mesh its own occluder, unless it can never fit the budget.
  static std::shared_ptr<const OccluderSet> own_occluders(const Scene& scene, const OcclusionMaskedConfig& config) {
    auto set = std::make_shared<OccluderSet>();
    set->by_mesh.resize(scene.meshes().size());
    parallel_blocks(set->by_mesh.size(), 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Mesh& mesh = scene.meshes()[i];
        if (mesh.triangles.size() <= static_cast<std::size_t>(config.triangles))
          set->by_mesh[i] = make_occluder(mesh.positions, mesh.triangles);
      }
    });
    return set;
  }

  static bool outside(const Frustum& frustum, const Aabb& box, std::uint32_t& planes) {
    for (int i = 0; i < frustum.count && planes != 0; ++i) {
      if (((planes >> i) & 1u) == 0) continue;
      const Containment c = classify(frustum.planes[static_cast<std::size_t>(i)], box);
      if (c == Containment::outside) return true;
      if (c == Containment::inside) planes &= ~(1u << i);
    }
    return false;
  }

  /// Opaque candidates in the frustum that look large, best first: seen size against triangles.
  void find_occluders(const View& view, const VisibleSet& candidates, Counters& counters) {
    choices_.clear();
    const bool all = candidates.is_all();
    const double focal = view.projection == Projection::perspective ? view.height / (2 * std::tan(0.5 * view.fov_y))
                                                                    : view.height / view.span_y;
    const glm::vec3 eye(view.eye);
    stack_.assign(1, {0, (1u << frustum_.count) - 1u});
    while (!stack_.empty()) {
      const auto [index, parent_planes] = stack_.back();
      stack_.pop_back();
      const BvhNode& node = bvh_.nodes[index];
      std::uint32_t planes = parent_planes;
      ++counters.nodes_visited;
      ++counters.boxes_tested;
      if (outside(frustum_, node.bounds, planes) || size_of(node.bounds, eye, focal, view) < config_.min_size) continue;
      if (!node.leaf()) {
        stack_.push_back({node.first + 1, planes});
        stack_.push_back({node.first, planes});
        continue;
      }
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const ObjectId id = bvh_.items[i];
        const Object& object = scene_.objects()[id];
        if (!object.opaque || object.bounds.empty() || (!all && !candidates.contains(id))) continue;
        std::uint32_t object_planes = planes;
        ++counters.boxes_tested;
        if (outside(frustum_, object.bounds, object_planes)) continue;
        const double size = size_of(object.bounds, eye, focal, view);
        if (size < config_.min_size) continue;
        const std::uint32_t triangles = triangles_of(object.mesh);
        if (triangles == 0 || size * size < config_.detail * triangles) continue;
        choices_.push_back({id, static_cast<float>(size * size / (triangles + 30.0))});
      }
    }
    std::sort(choices_.begin(), choices_.end(),
              [](const Choice& a, const Choice& b) { return a.value != b.value ? a.value > b.value : a.id < b.id; });
  }

  /// About how many view pixels the middle extent of a box looks long from the eye; infinity for an eye inside.
  static double size_of(const Aabb& box, const glm::vec3& eye, double focal, const View& view) {
    const glm::vec3 extent = box.extent();
    const float shortest = std::min({extent.x, extent.y, extent.z}), longest = std::max({extent.x, extent.y, extent.z});
    const float middle = extent.x + extent.y + extent.z - shortest - longest;
    const float size = std::sqrt(middle * longest);
    if (view.projection == Projection::orthographic) return focal * static_cast<double>(size);
    const float distance = glm::length(glm::max(glm::max(box.lo - eye, eye - box.hi), glm::vec3(0.0f)));
    return focal * static_cast<double>(size) / std::max(static_cast<double>(distance), view.near);
  }

  /// How many of the choices from `next` on may still be seen: about what more occluders could be good for.
  [[nodiscard]] std::int64_t open_choices(std::size_t next) const {
    return std::count_if(choices_.begin() + static_cast<std::ptrdiff_t>(next), choices_.end(), [&](const Choice& c) {
      return buffer_.may_be_seen_by_rectangle(scene_.objects()[c.id].bounds);
    });
  }

  /// The best first, in rounds: what one round hides is not drawn in the next, and costs nothing of the budget; nor is
  /// what has more triangles than all that it could still hide is worth, the very best one excepted.
  void draw_occluders(const View& view, Counters& counters) {
    const auto scaled = [&](int pixels) {
      return std::clamp(static_cast<int>(std::lround(pixels * config_.resolution)), 1, 16384);
    };
    buffer_.begin(view, scaled(view.width), scaled(view.height),
                  config_.centres ? Coverage::centres : Coverage::squares);
    std::int64_t budget = config_.triangles, round_size = 1024;
    for (std::size_t next = 0; next < choices_.size() && budget > 0; round_size *= 2) {
      round_.clear();
      const double worth = config_.worth * static_cast<double>(open_choices(next));
      for (std::int64_t round = round_size; next < choices_.size() && round > 0; ++next) {
        const Object& object = scene_.objects()[choices_[next].id];
        const std::uint32_t triangles = triangles_of(object.mesh);
        if (triangles > budget || (next > 0 && triangles > worth) || !buffer_.may_be_seen_by_rectangle(object.bounds))
          continue;
        budget -= triangles;
        round -= triangles;
        round_.push_back({&occluders_->by_mesh[object.mesh], object.transform});
        if (!occluders_->solids.empty() && behind_near(object.bounds, view))
          round_.push_back({&occluders_->solids[object.mesh], object.transform});
      }
      buffer_.add_occluders(round_);
    }
    counters.occluders += buffer_.counts().occluders;
    counters.occluder_triangles += buffer_.counts().occluder_triangles;
  }

  void collect(const View& view, const VisibleSet& candidates, VisibleSet& visible, Counters& counters) {
    const bool all = candidates.is_all();
    const glm::vec3 direction(view_direction(view));
    stack_.clear();
    std::uint32_t root_planes = (1u << frustum_.count) - 1u;
    if (!outside(frustum_, bvh_.nodes[0].bounds, root_planes)) stack_.push_back({0, root_planes});
    while (!stack_.empty()) {
      const auto [index, planes] = stack_.back();
      stack_.pop_back();
      const BvhNode& node = bvh_.nodes[index];
      ++counters.nodes_visited;
      if (node.leaf()) {
        collect_objects(node, planes, all, candidates, visible, counters);
        continue;
      }
      const Aabb boxes[2] = {bvh_.nodes[node.first].bounds, bvh_.nodes[node.first + 1].bounds};
      std::uint32_t masks[2] = {planes, planes};
      std::uint8_t seen[2];
      buffer_.test(boxes, seen, false);
      counters.boxes_tested += 2;
      counters.queries += 2;
      const std::uint32_t near = glm::dot(direction, boxes[0].centre() - boxes[1].centre()) <= 0.0f ? 0u : 1u;
      for (const std::uint32_t child : {1u - near, near})
        if (seen[child] != 0 && !outside(frustum_, boxes[child], masks[child]))
          stack_.push_back({node.first + child, masks[child]});
    }
  }

  void collect_objects(const BvhNode& leaf, std::uint32_t planes, bool all, const VisibleSet& candidates,
                       VisibleSet& visible, Counters& counters) {
    leaf_ids_.clear();
    leaf_boxes_.clear();
    for (std::uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
      const ObjectId id = bvh_.items[i];
      const Aabb& box = scene_.objects()[id].bounds;
      if ((!all && !candidates.contains(id)) || box.empty()) continue;
      ++counters.boxes_tested;
      std::uint32_t object_planes = planes;
      if (outside(frustum_, box, object_planes)) continue;
      leaf_ids_.push_back(id);
      leaf_boxes_.push_back(box);
    }
    counters.queries += leaf_ids_.size();
    leaf_seen_.resize(leaf_ids_.size());
    buffer_.test(leaf_boxes_, leaf_seen_);
    for (std::size_t i = 0; i < leaf_ids_.size(); ++i)
      if (leaf_seen_[i] != 0 && parts_may_be_seen(leaf_ids_[i], counters)) visible.insert(leaf_ids_[i]);
  }

  /// The tight bounds of an object whose box may be seen; true without.
  bool parts_may_be_seen(ObjectId id, Counters& counters) const {
    if (tight_.empty() || tight_.boxes(id).size() <= 1) return true;
    return tight_.any(id, [&](const Aabb& part) {
      ++counters.queries;
      return buffer_.may_be_seen(part);
    });
  }

  const Scene& scene_;
  const Bvh& bvh_;
  OcclusionMaskedConfig config_;
  OcclusionBuffer buffer_;
  std::shared_ptr<const OccluderSet> occluders_;
  OccludeeBounds tight_;  // empty without
  Frustum frustum_;
  std::vector<Visit> stack_;
  std::vector<Choice> choices_;
  std::vector<OccluderInstance> round_;
  std::vector<ObjectId> leaf_ids_;
  std::vector<Aabb> leaf_boxes_;
  std::vector<std::uint8_t> leaf_seen_;
};

}  // namespace

std::unique_ptr<Culler> make_occlusion_masked(const IndexedScene& scene, const OcclusionMaskedConfig& config) {
  return std::make_unique<OcclusionMasked>(scene, config);
}

std::unique_ptr<Culler> make_occlusion_masked(const IndexedScene& scene, ParameterReader& parameters) {
  OcclusionMaskedConfig config;
  parameters.read("resolution", config.resolution, 1.0 / 16, 2.0);
  parameters.read("triangles", config.triangles, 0, 1 << 30);
  parameters.read("worth", config.worth, 0.0, 1e9);
  parameters.read("min_size", config.min_size, 0.0, 1e6);
  parameters.read("detail", config.detail, 0.0, 1e6);
  parameters.read("centres", config.centres);
  parameters.read("scalar", config.scalar);
  parameters.read("tight", config.tight, 1.0, 100.0);
  parameters.read("auto_budget", config.auto_budget, 0, 1 << 30);
  std::string occluders = "all";
  parameters.read("occluders", occluders);
  parameters.finish();
  if (occluders != "all" && occluders != "auto")
    throw InputError("occlusion_masked", "occluders", "must be all or auto, not '" + occluders + "'");
  config.automatic = occluders == "auto";
  if (config.centres && config.resolution != 1.0)
    throw InputError("occlusion_masked", "centres",
                     "pixel centres alone count only in a buffer of the view's size: resolution=1");
  return make_occlusion_masked(scene, config);
}

}  // namespace sightline
