#include "sightline/cull/occlusion_virtual.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sightline/cull/occlusion_stage.hpp"
#include "sightline/scene/input_error.hpp"

namespace sightline {
namespace {

/// Where a ray enters a box, as its parameter; infinity if it does not. Slab test (Kay and Kajiya 1986); a ray within a
/// slab's plane counts as inside of it. The box is grown by what float bounds may be off.
double enter(const PixelRay& ray, const Aabb& box) {
  double from = ray.t_near, to = ray.t_far;
  for (int axis = 0; axis < 3; ++axis) {
    const double slack = 1e-6 * (std::abs(ray.origin[axis]) + std::abs(static_cast<double>(box.hi[axis])) +
                                 std::abs(static_cast<double>(box.lo[axis])));
    const double lo = static_cast<double>(box.lo[axis]) - slack - ray.origin[axis];
    const double hi = static_cast<double>(box.hi[axis]) + slack - ray.origin[axis];
    const double d = ray.direction[axis];
    if (d == 0.0) {
      if (lo > 0.0 || hi < 0.0) return std::numeric_limits<double>::infinity();
      continue;
    }
    from = std::max(from, std::min(lo / d, hi / d));
    to = std::min(to, std::max(lo / d, hi / d));
  }
  return from <= to ? from : std::numeric_limits<double>::infinity();
}

class OcclusionVirtual final : public Culler {
 public:
  OcclusionVirtual(const IndexedScene& scene, const OcclusionStageConfig& config, int step, int pixels)
      : stage_(scene, config), step_(step), pixels_(pixels) {}

  void cull(const View& view, const VisibleSet& candidates, VisibleSet& visible, Counters& counters) override {
    visible.reset(candidates.universe());
    stage_.begin(view, candidates, counters);
    for (const StagedObject& object : stage_.objects()) {
      const auto seen = [&](std::span<const Occludee> boxes) {
        int passed = 0;
        for (const Occludee& box : boxes) {
          ++counters.queries;
          passed += passing(view, box, pixels_ - passed, counters);
          if (passed > pixels_) return true;
        }
        return false;
      };
      if (!stage_.may_be_seen(object, seen)) continue;
      visible.insert(object.id);
      stage_.draw(object);
    }
    stage_.end(counters);
  }

  bool follow_scene() override {
    stage_.follow_scene();
    return true;
  }

  [[nodiscard]] Promise promise(Promise of_row) const override {
    return step_ == 1 && pixels_ == 0 ? Promise::conservative : of_row;
  }

 private:
  /// How many samples of a box pass, counted until there are more than `enough`. Samples stand at fixed pixels of the
  /// image, as in the paper, so that neighbouring boxes agree; a rectangle that lies between them gets its own middle.
  int passing(const View& view, const Occludee& box, int enough, Counters& counters) const {
    const BoxFootprint& f = box.footprint;
    const auto sample = [&](int x, int y) {
      ++counters.cells_tested;
      const double t = enter(pixel_ray(view, x + 0.5, y + 0.5), box.bounds);
      return std::isfinite(t) && !behind(t, stage_.buffer().hidden_beyond(x, y)) ? 1 : 0;
    };
    const int left = (f.x0 + step_ - 1) / step_ * step_, top = (f.y0 + step_ - 1) / step_ * step_;
    if (left >= f.x1 || top >= f.y1) return sample((f.x0 + f.x1) / 2, (f.y0 + f.y1) / 2);
    int passed = 0;
    for (int y = top; y < f.y1; y += step_)
      for (int x = left; x < f.x1; x += step_)
        if ((passed += sample(x, y)) > enough) return passed;
    return passed;
  }

  OcclusionStage stage_;
  int step_, pixels_;
};

}  // namespace

std::unique_ptr<Culler> make_occlusion_virtual(const IndexedScene& scene, ParameterReader& parameters) {
  OcclusionStageConfig config;
  int step = 4, pixels = 0;
  config.resolution = 1.0;
  read_stage(parameters, config);
  if (config.resolution != 1.0)
    throw InputError("occlusion_virtual", "resolution", "must be 1: samples are the view's own pixel centres");
  parameters.read("step", step, 1, 64);
  parameters.read("pixels", pixels, 0, 1000000);
  parameters.finish();
  return std::make_unique<OcclusionVirtual>(scene, config, step, pixels);
}

}  // namespace sightline
