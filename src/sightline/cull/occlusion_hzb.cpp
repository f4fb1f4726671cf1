#include "sightline/cull/occlusion_hzb.hpp"

#include "sightline/cull/occlusion_stage.hpp"
#include "sightline/raster/z_pyramid.hpp"

namespace sightline {
namespace {

class OcclusionHzb final : public Culler {
 public:
  OcclusionHzb(const IndexedScene& scene, const OcclusionStageConfig& config, int fan, double pixels)
      : stage_(scene, config), fan_(fan), pixels_(pixels) {}

  void cull(const View& view, const VisibleSet& candidates, VisibleSet& visible, Counters& counters) override {
    visible.reset(candidates.universe());
    stage_.begin(view, candidates, counters);
    pyramid_.reset(stage_.width(), stage_.height(), fan_);
    const int enough = stage_.scaled_pixels(pixels_);
    for (const StagedObject& object : stage_.objects()) {
      const auto seen = [&](std::span<const Occludee> boxes) {
        int open = 0;
        for (const auto& [bounds, f] : boxes) {
          ++counters.queries;
          open += pyramid_.open_pixels(f.x0, f.y0, f.x1, f.y1, f.nearest, enough - open, counters.cells_tested);
          if (open > enough) return true;
        }
        return false;
      };
      if (!stage_.may_be_seen(object, seen)) continue;
      visible.insert(object.id);
      if (stage_.draw(object)) take_over(object.footprint);
    }
    stage_.end(counters);
  }

  bool follow_scene() override {
    stage_.follow_scene();
    return true;
  }

  [[nodiscard]] Promise promise(Promise of_row) const override { return pixels_ > 0 ? Promise::approximate : of_row; }

 private:
  /// What was drawn changed the depth image within the object's rectangle only.
  void take_over(const BoxFootprint& f) {
    for (int y = f.y0; y < f.y1; ++y)
      for (int x = f.x0; x < f.x1; ++x) pyramid_.pixel(x, y) = stage_.buffer().hidden_beyond(x, y);
    pyramid_.refresh(f.x0, f.y0, f.x1, f.y1);
  }

  OcclusionStage stage_;
  ZPyramid pyramid_;
  int fan_;
  double pixels_;
};

}  // namespace

std::unique_ptr<Culler> make_occlusion_hzb(const IndexedScene& scene, ParameterReader& parameters) {
  OcclusionStageConfig config;
  int fan = 2;
  double pixels = 0;
  read_stage(parameters, config);
  parameters.read("fan", fan, 2, 16);
  parameters.read("pixels", pixels, 0.0, 1e6);
  parameters.finish();
  return std::make_unique<OcclusionHzb>(scene, config, fan, pixels);
}

}  // namespace sightline
