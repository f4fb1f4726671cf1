#include "sightline/cull/occlusion_hom.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "sightline/cull/occlusion_stage.hpp"
#include "sightline/raster/overlap_pyramid.hpp"
#include "sightline/scene/input_error.hpp"

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
  [[nodiscard]] bool before(const BoxFootprint& f) const {
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

/// From what the estimate is made: the boxes of the occluders (1997), or their drawn depth (1998).
enum class DepthSource { boxes, buffer };

class OcclusionHom final : public Culler {
 public:
  OcclusionHom(const IndexedScene& scene, const OcclusionStageConfig& config, DepthSource source, double opacity,
               double holes, int block)
      : stage_(scene, config), source_(source), opacity_(opacity), holes_(holes), block_(block) {}

  void cull(const View& view, const VisibleSet& candidates, VisibleSet& visible, Counters& counters) override {
    visible.reset(candidates.universe());
    stage_.begin(view, candidates, counters);
    draw_occluders();
    stage_.end(counters);
    const OverlapPyramid::Threshold threshold{opacity_, static_cast<double>(stage_.scaled_pixels(holes_))};
    const auto seen = [&](std::span<const Occludee> boxes) {
      return std::any_of(boxes.begin(), boxes.end(), [&](const Occludee& box) {
        const BoxFootprint& f = box.footprint;
        ++counters.queries;
        return !depth_.before(f) || !overlap_.covers(f.x0, f.y0, f.x1, f.y1, threshold, counters.cells_tested);
      });
    };
    for (const StagedObject& object : stage_.objects())
      if (stage_.may_be_seen(object, seen)) visible.insert(object.id);
  }

  bool follow_scene() override {
    stage_.follow_scene();
    return true;
  }

  [[nodiscard]] Promise promise(Promise of_row) const override {
    return opacity_ < 1 || holes_ > 0 ? Promise::approximate : of_row;
  }

 private:
  /// The occluder selection: what looks large and lies near, until the budget of triangles is spent. What reaches
  /// before the near plane (indoors: the walls around the eye) looks largest of all, but its box estimates no depth.
  void select_occluders() {
    order_.clear();
    const std::span<const StagedObject> objects = stage_.objects();
    for (std::uint32_t i = 0; i < objects.size(); ++i)
      if (source_ == DepthSource::buffer || objects[i].footprint.place == BoxPlace::rectangle) order_.push_back(i);
    const auto distance = [&](std::uint32_t i) {
      const BoxFootprint& f = objects[i].footprint;
      return std::max(0.0, source_ == DepthSource::buffer ? f.nearest : f.farthest);
    };
    const auto value = [&](std::uint32_t i) { return objects[i].footprint.pixels() / (1e-3 + distance(i)); };
    std::stable_sort(order_.begin(), order_.end(), [&](auto a, auto b) { return value(a) > value(b); });
    std::erase_if(order_, [&](std::uint32_t i) { return !stage_.reserve(objects[i]); });
    std::stable_sort(order_.begin(), order_.end(), [&](auto a, auto b) { return distance(a) < distance(b); });
  }

  void draw_occluders() {
    select_occluders();
    depth_.reset(stage_.width(), stage_.height(), block_);
    overlap_.reset(stage_.width(), stage_.height());
    for (const std::uint32_t i : order_) {
      stage_.draw_reserved(stage_.objects()[i]);
      if (source_ == DepthSource::boxes) take_over_by_box(stage_.objects()[i].footprint);
    }
    if (source_ == DepthSource::buffer) take_over_by_depth();
    overlap_.build();
  }

  /// Lets an occluder, the nearest ones first, deepen the estimate only where it covers what was open: everything else
  /// is hidden by nearer ones already.
  void take_over_by_box(const BoxFootprint& f) {
    const auto farthest = static_cast<float>(f.farthest + std::abs(f.farthest) * 1e-6);
    for (int y = f.y0; y < f.y1; ++y)
      for (int x = f.x0; x < f.x1; ++x)
        if (!overlap_.covered(x, y) && std::isfinite(stage_.buffer().hidden_beyond(x, y))) {
          overlap_.cover(x, y);
          depth_.add(x, y, farthest);
        }
  }

  /// A z-buffer without background: the open pixels do not count.
  void take_over_by_depth() {
    for (int y = 0; y < stage_.height(); ++y)
      for (int x = 0; x < stage_.width(); ++x)
        if (const float depth = stage_.buffer().hidden_beyond(x, y); std::isfinite(depth)) {
          overlap_.cover(x, y);
          depth_.add(x, y, depth);
        }
  }

  OcclusionStage stage_;
  OverlapPyramid overlap_;
  DepthEstimate depth_;
  DepthSource source_;
  double opacity_, holes_;
  int block_;
  std::vector<std::uint32_t> order_;
};

}  // namespace

std::unique_ptr<Culler> make_occlusion_hom(const IndexedScene& scene, ParameterReader& parameters) {
  OcclusionStageConfig config;
  double opacity = 1, holes = 0;
  int block = 16;
  std::string depth = "buffer";
  read_stage(parameters, config);
  parameters.read("depth", depth);
  parameters.read("opacity", opacity, 0.5, 1.0);
  parameters.read("holes", holes, 0.0, 1e6);
  parameters.read("block", block, 1, 256);
  parameters.finish();
  if (depth != "buffer" && depth != "boxes")
    throw InputError("", "occlusion_hom: depth", "must be buffer or boxes, not '" + depth + "'");
  const DepthSource source = depth == "boxes" ? DepthSource::boxes : DepthSource::buffer;
  return std::make_unique<OcclusionHom>(scene, config, source, opacity, holes, block);
}

}  // namespace sightline
