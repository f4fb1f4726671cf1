#include "sightline/cull/frustum_bounds.hpp"

#include <array>
#include <string>
#include <variant>

#include "sightline/geometry/clip_boxes.hpp"
#include "sightline/geometry/kdop.hpp"
#include "sightline/geometry/obb.hpp"
#include "sightline/parallel/parallel.hpp"
#include "sightline/scene/frustum_shape.hpp"
#include "sightline/scene/input_error.hpp"
#include "sightline/scene/object_hulls.hpp"

namespace sightline {
namespace {

enum class Bound { sphere, ritter, aabb, obb_pca, obb, kdop, hull };

struct FrustumBoundsConfig {
  Bound bound = Bound::sphere;
  int k = 0;               // of the k-DOP
  bool meta = false;       // first the sphere and the box around the frustum (20.15)
  bool clip = false;       // boxes in clip space (20.19) instead of planes
  bool coherence = false;  // the plane that rejected last time goes first (20.16)
};

/// Any convex volume with corners: k-DOP or hull.
struct Corners {
  std::vector<glm::vec3> points;
  float slack;
};
using Volume = std::variant<Aabb, Sphere, Obb, Corners>;

Volume volume_of(const FrustumBoundsConfig& config, const ConvexHull& hull, const Aabb& box) {
  const auto grown = [&](Sphere sphere) {
    if (sphere.radius >= 0.0f) sphere.radius += hull.slack;
    return sphere;
  };
  switch (config.bound) {
    case Bound::sphere:
      return grown(smallest_sphere(hull.vertices));
    case Bound::ritter:
      return grown(ritter_sphere(hull.vertices));
    case Bound::obb: {
      Obb fitted = fitted_box(hull);
      if (fitted.radii.x >= 0.0f) fitted.radii += glm::vec3(hull.slack);
      return fitted;
    }
    case Bound::obb_pca: {
      Obb principal = pca_box(hull.vertices);
      if (principal.radii.x >= 0.0f) principal.radii += glm::vec3(hull.slack);
      return principal;
    }
    case Bound::kdop: {
      const ConvexHull corners = polytope(make_kdop(hull.vertices, config.k));
      return Corners{corners.vertices, corners.slack + hull.slack};
    }
    case Bound::hull:
      return Corners{hull.vertices, hull.slack};
    case Bound::aabb:
      break;
  }
  return box;
}

class FrustumBounds final : public Culler {
 public:
  FrustumBounds(const Scene& scene, const FrustumBoundsConfig& config)
      : config_(config), reach_(reach(scene.bounds())), volumes_(scene.objects().size()), last_(volumes_.size(), 0) {
    const std::vector<ConvexHull> hulls = config.bound == Bound::aabb ? std::vector<ConvexHull>() : mesh_hulls(scene);
    parallel_blocks(volumes_.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Object& object = scene.objects()[i];
        const ConvexHull hull = hulls.empty() ? ConvexHull() : placed_hull(hulls[object.mesh], object.transform);
        volumes_[i] = volume_of(config, hull, object.bounds);
      }
    });
    boxes_ = scene.object_bounds();
  }

  void cull(const View& view, const VisibleSet& candidates, VisibleSet& visible, Counters& counters) override {
    visible.reset(candidates.universe());
    const Frustum frustum = view_frustum(view, reach_);
    const glm::dmat4 clip = view_projection(view);
    const double far = 4.0 * (reach_ + glm::length(view.eye));
    const Sphere meta_sphere = frustum_sphere(view, far);
    const Aabb meta_box = frustum_box(view, far);
    for (const ObjectId id : candidates.order()) {
      if (boxes_[id].empty()) continue;
      ++counters.boxes_tested;
      if (config_.meta) {
        if (!boxes_[id].overlaps(meta_box)) continue;
        if (const Sphere* sphere = std::get_if<Sphere>(&volumes_[id]);
            sphere != nullptr && !overlaps(*sphere, meta_sphere))
          continue;
      }
      if (config_.coherence && outside_of_last(frustum, id)) continue;
      if (test(frustum, clip, id) != Containment::outside) visible.insert(id);
    }
  }

  void reset() override { std::fill(last_.begin(), last_.end(), std::uint8_t{0}); }

 private:
  [[nodiscard]] Containment test(const Frustum& frustum, const glm::dmat4& clip, ObjectId id) {
    if (config_.clip) {
      // In doubles; the box is rounded outwards already.
      return classify_in_clip_space(boxes_[id], clip);
    }
    return std::visit([&](const auto& volume) { return classify_and_remember(frustum, volume, id); }, volumes_[id]);
  }

  static Containment classify_one(const Frustum& frustum, const Corners& corners) {
    return classify(frustum, corners.points, corners.slack);
  }
  template <class V>
  static Containment classify_one(const Frustum& frustum, const V& volume) {
    return classify(frustum, volume);
  }

  template <class V>
  Containment classify_and_remember(const Frustum& frustum, const V& volume, ObjectId id) {
    if (!config_.coherence) return classify_one(frustum, volume);
    for (int i = 0; i < frustum.count; ++i) {
      Frustum one;
      one.planes[0] = frustum.planes[static_cast<std::size_t>(i)];
      one.count = 1;
      if (classify_one(one, volume) == Containment::outside) {
        last_[id] = static_cast<std::uint8_t>(i);
        return Containment::outside;
      }
    }
    return Containment::intersecting;
  }

  bool outside_of_last(const Frustum& frustum, ObjectId id) const {
    if (last_[id] >= frustum.count) return false;
    Frustum one;
    one.planes[0] = frustum.planes[last_[id]];
    one.count = 1;
    return std::visit([&](const auto& volume) { return classify_one(one, volume); }, volumes_[id]) ==
           Containment::outside;
  }

  FrustumBoundsConfig config_;
  double reach_;
  std::vector<Volume> volumes_;
  std::vector<Aabb> boxes_;
  std::vector<std::uint8_t> last_;  // the plane that rejected the object last
};

}  // namespace

std::unique_ptr<Culler> make_frustum_bounds(const IndexedScene& scene, ParameterReader& parameters) {
  FrustumBoundsConfig config;
  std::string bound = "sphere", test = "planes";
  parameters.read("bound", bound);
  parameters.read("test", test);
  parameters.read("meta", config.meta);
  parameters.read("coherence", config.coherence);
  parameters.finish();
  constexpr std::array<std::pair<std::string_view, Bound>, 6> names{{{"sphere", Bound::sphere},
                                                                     {"ritter", Bound::ritter},
                                                                     {"aabb", Bound::aabb},
                                                                     {"obb_pca", Bound::obb_pca},
                                                                     {"obb", Bound::obb},
                                                                     {"hull", Bound::hull}}};
  bool known = false;
  for (const auto& [name, value] : names)
    if (bound == name) {
      config.bound = value;
      known = true;
    }
  for (const int k : {6, 14, 18, 26})
    if (bound == "kdop" + std::to_string(k)) {
      config.bound = Bound::kdop;
      config.k = k;
      known = true;
    }
  if (!known)
    throw InputError("", "frustum_bounds: bound",
                     "must be sphere, ritter, aabb, obb_pca, obb, kdop6, kdop14, kdop18, kdop26 or hull");
  if (test != "planes" && test != "clip") throw InputError("", "frustum_bounds: test", "must be planes or clip");
  config.clip = test == "clip";
  if (config.clip && config.bound != Bound::aabb) throw InputError("", "frustum_bounds: test", "clip needs bound=aabb");
  return std::make_unique<FrustumBounds>(scene.scene, config);
}

}  // namespace sightline
