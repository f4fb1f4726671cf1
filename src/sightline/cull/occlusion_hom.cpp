#include "sightline/cull/occlusion_hom.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sightline/cull/occlusion_stage.hpp"
#include "sightline/raster/overlap_pyramid.hpp"

namespace sightline {
namespace {

/// For every block of the image the farthest that any occluder touching it can be. Farther is behind all of them.
class DepthEstimate {
 public:
  void reset(int width, int height, int block) {
    block_ = block;
    across_ = (width + block - 1) / block;
    farthest_.assign(static_cast<std::size_t>(across_) * static_cast<std::size_t>((height + block - 1) / block),
                     -std::numeric_limits<float>::infinity());
  }
  void add(const BoxFootprint& f) {
    const auto depth = static_cast<float>(f.farthest + std::abs(f.farthest) * 1e-6);
    each(f, [&](float& farthest) { farthest = std::max(farthest, depth); });
  }
  [[nodiscard]] bool in_front_of(const BoxFootprint& f) {
    bool all = true;
    each(f, [&](const float& farthest) { all = all && behind(f.nearest, farthest); });
    return all;
  }

 private:
  template <class F>
  void each(const BoxFootprint& f, F&& visit) {
    for (int y = f.y0 / block_; y <= (f.y1 - 1) / block_; ++y)
      for (int x = f.x0 / block_; x <= (f.x1 - 1) / block_; ++x)
        visit(farthest_[static_cast<std::size_t>(y) * static_cast<std::size_t>(across_) + static_cast<std::size_t>(x)]);
  }
  int block_ = 1, across_ = 1;
  std::vector<float> farthest_;
};

class OcclusionHom final : public Culler {
 public:
  OcclusionHom(const IndexedScene& scene, const OcclusionStageConfig& config, double opacity, double holes, int block)
      : stage_(scene, config), opacity_(opacity), holes_(holes), block_(block) {}

  void cull(const View& view, const VisibleSet& candidates, VisibleSet& visible, Counters& counters) override {
    visible.reset(candidates.universe());
    stage_.begin(view, candidates, counters);
    draw_occluders();
    stage_.end(counters);
    const OverlapPyramid::Threshold threshold{opacity_, static_cast<double>(stage_.scaled_pixels(holes_))};
    for (const StagedObject& object : stage_.objects()) {
      const BoxFootprint& f = object.footprint;
      if (f.place == BoxPlace::rectangle) {
        ++counters.queries;
        if (depth_.in_front_of(f) && overlap_.covers(f.x0, f.y0, f.x1, f.y1, threshold, counters.cells_tested))
          continue;
      }
      visible.insert(object.id);
    }
  }

  [[nodiscard]] bool approximate() const override { return opacity_ < 1 || holes_ > 0; }

 private:
  /// The occluder selection: what looks large and lies near comes first, until the budget of triangles is spent. What
  /// reaches before the near plane comes last, as its depth is the worst of estimates.
  void draw_occluders() {
    order_.resize(stage_.objects().size());
    for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
    const auto value = [&](std::uint32_t i) {
      const StagedObject& object = stage_.objects()[i];
      if (object.footprint.place == BoxPlace::everywhere) return 0.0;
      return object.footprint.pixels() / (1e-3 + std::abs(object.footprint.farthest));
    };
    std::stable_sort(order_.begin(), order_.end(), [&](auto a, auto b) { return value(a) > value(b); });
    depth_.reset(stage_.width(), stage_.height(), block_);
    for (const std::uint32_t i : order_)
      if (stage_.objects()[i].footprint.place == BoxPlace::rectangle && stage_.draw(stage_.objects()[i]))
        depth_.add(stage_.objects()[i].footprint);
    overlap_.reset(stage_.width(), stage_.height());
    for (int y = 0; y < stage_.height(); ++y)
      for (int x = 0; x < stage_.width(); ++x)
        if (std::isfinite(stage_.buffer().hidden_beyond(x, y))) overlap_.cover(x, y);
    overlap_.build();
  }

  OcclusionStage stage_;
  OverlapPyramid overlap_;
  DepthEstimate depth_;
  double opacity_, holes_;
  int block_;
  std::vector<std::uint32_t> order_;
};

}  // namespace

std::unique_ptr<Culler> make_occlusion_hom(const IndexedScene& scene, ParameterReader& parameters) {
  OcclusionStageConfig config;
  double opacity = 1, holes = 0;
  int block = 16;
  read_stage(parameters, config);
  parameters.read("opacity", opacity, 0.5, 1.0);
  parameters.read("holes", holes, 0.0, 1e6);
  parameters.read("block", block, 1, 256);
  parameters.finish();
  return std::make_unique<OcclusionHom>(scene, config, opacity, holes, block);
}

}  // namespace sightline
