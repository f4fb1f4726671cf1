#include "sightline/cull/frustum_linear.hpp"

#include "sightline/geometry/frustum_boxes.hpp"

namespace sightline {
namespace {

class FrustumLinear final : public Culler {
 public:
  FrustumLinear(const Scene& scene, bool scalar)
      : scene_(scene),
        boxes_(scene.object_bounds()),
        reach_(reach(scene.bounds())),
        scalar_(scalar),
        ids_(boxes_.count + 64) {}

  void cull(const View& view, const VisibleSet& candidates, VisibleSet& visible, Counters& counters) override {
    visible.reset(candidates.universe());
    const Frustum frustum = view_frustum(view, reach_);
    const std::size_t found = scalar_ ? boxes_in_frustum_scalar(boxes_, frustum, ids_.data())
                                      : boxes_in_frustum(boxes_, frustum, ids_.data());
    const bool all = candidates.is_all();
    if (all) {
      visible.insert_new({ids_.data(), found});
    } else {
      for (std::size_t i = 0; i < found; ++i)
        if (candidates.contains(ids_[i])) visible.insert(ids_[i]);
    }
    counters.boxes_tested += boxes_.count;
  }

  bool follow_scene() override {
    boxes_ = BoxArrays(scene_.object_bounds());
    reach_ = reach(scene_.bounds());
    return true;
  }

 private:
  const Scene& scene_;
  BoxArrays boxes_;
  double reach_;
  bool scalar_;
  std::vector<ObjectId> ids_;
};

}  // namespace

std::unique_ptr<Culler> make_frustum_linear(const IndexedScene& scene, ParameterReader& parameters) {
  bool scalar = false;
  parameters.read("scalar", scalar);
  parameters.finish();
  return std::make_unique<FrustumLinear>(scene.scene, scalar);
}

}  // namespace sightline
