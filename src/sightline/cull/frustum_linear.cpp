#include "sightline/cull/frustum_linear.hpp"

namespace sightline {
namespace {

class FrustumLinear final : public Culler {
 public:
  explicit FrustumLinear(const Scene& scene) : scene_(scene) {}

  void cull(const View& view, const VisibleSet& candidates, VisibleSet& visible, Counters& counters) override {
    visible.reset(candidates.universe());
    const Frustum frustum = view_frustum(view, reach(scene_.bounds()));
    for (const ObjectId id : candidates.order()) {
      const Aabb& box = scene_.objects()[id].bounds;
      if (!box.empty() && classify(frustum, box) != Containment::outside) visible.insert(id);
    }
    counters.boxes_tested += candidates.count();
  }

 private:
  const Scene& scene_;
};

}  // namespace

std::unique_ptr<Culler> make_frustum_linear(const IndexedScene& scene, ParameterReader& parameters) {
  parameters.finish();
  return std::make_unique<FrustumLinear>(scene.scene);
}

}  // namespace sightline
