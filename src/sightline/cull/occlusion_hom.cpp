#include "sightline/cull/occlusion_hom.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sightline/cull/occlusion_stage.hpp"
#include "sightline/raster/overlap_pyramid.hpp"

namespace sightline {
namespace {

/// For every block of the image the farthest that an occluder which covers a pixel of it can be.
class DepthEstimate {
 public:
  void reset(int width, int height, int block) {
    block_ = block;
    across_ = (width + block - 1) / block;
    farthest_.assign(static_cast<std::size_t>(across_) * static_cast<std::size_t>((height + block - 1) / block),
                     -std::numeric_limits<float>::infinity());
  }
  void add(int x, int y, float farthest) {
    float& depth = farthest_[index(x / block_, y / block_)];
    depth = std::max(depth, farthest);
  }
  /// True if the box lies behind the estimate in every block that its rectangle touches.
  [[nodiscard]] bool in_front_of(const BoxFootprint& f) const {
    for (int y = f.y0 / block_; y <= (f.y1 - 1) / block_; ++y)
      for (int x = f.x0 / block_; x <= (f.x1 - 1) / block_; ++x)
        if (!behind(f.nearest, farthest_[index(x, y)])) return false;
    return true;
  }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(across_) + static_cast<std::size_t>(x);
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
  /// The occluder selection: what looks large and lies near, until the budget of triangles is spent. What reaches
  /// before the near plane is left out, as its depth is the worst of estimates.
  void select_occluders() {
    order_.clear();
    const std::span<const StagedObject> objects = stage_.objects();
    for (std::uint32_t i = 0; i < objects.size(); ++i)
      if (objects[i].footprint.place == BoxPlace::rectangle) order_.push_back(i);
    const auto value = [&](std::uint32_t i) {
      return objects[i].footprint.pixels() / (1e-3 + std::abs(objects[i].footprint.farthest));
    };
    std::stable_sort(order_.begin(), order_.end(), [&](auto a, auto b) { return value(a) > value(b); });
    std::erase_if(order_, [&](std::uint32_t i) { return !stage_.reserve(objects[i]); });
    std::stable_sort(order_.begin(), order_.end(),
                     [&](auto a, auto b) { return objects[a].footprint.farthest < objects[b].footprint.farthest; });
  }

  /// Draws nearest first, and lets an occluder deepen the estimate only where it covers what was open: everything else
  /// is hidden by nearer ones already.
  void draw_occluders() {
    select_occluders();
    depth_.reset(stage_.width(), stage_.height(), block_);
    overlap_.reset(stage_.width(), stage_.height());
    for (const std::uint32_t i : order_) {
      const StagedObject& object = stage_.objects()[i];
      const BoxFootprint& f = object.footprint;
      stage_.draw_reserved(object);
      const auto farthest = static_cast<float>(f.farthest + std::abs(f.farthest) * 1e-6);
      for (int y = f.y0; y < f.y1; ++y)
        for (int x = f.x0; x < f.x1; ++x)
          if (!overlap_.covered(x, y) && std::isfinite(stage_.buffer().hidden_beyond(x, y))) {
            overlap_.cover(x, y);
            depth_.add(x, y, farthest);
          }
    }
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
