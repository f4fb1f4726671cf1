#include "sightline/cull/occlusion_map.hpp"

#include <algorithm>
#include <cmath>

#include "sightline/cull/occlusion_stage.hpp"
#include "sightline/raster/occupancy_map.hpp"

namespace sightline {

std::vector<std::uint32_t> overlap_free_batches(std::span<const BoxFootprint> rectangles, std::uint32_t longest) {
  // A coarse grid over the image remembers, cell by cell, the last batch that touches it; a rectangle comes after all
  // that it may overlap. Cells make more overlaps than there are, never fewer.
  constexpr int cell = 16;
  int width = 1, height = 1;
  for (const BoxFootprint& r : rectangles) {
    width = std::max(width, (r.x1 + cell - 1) / cell);
    height = std::max(height, (r.y1 + cell - 1) / cell);
  }
  std::vector<std::uint32_t> next(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
  std::vector<std::uint32_t> batch(rectangles.size()), used;
  for (std::size_t i = 0; i < rectangles.size(); ++i) {
    const BoxFootprint& r = rectangles[i];
    const auto each = [&](auto&& f) {
      for (int y = r.y0 / cell; y <= (r.y1 - 1) / cell; ++y)
        for (int x = r.x0 / cell; x <= (r.x1 - 1) / cell; ++x)
          f(next[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)]);
    };
    std::uint32_t first = 0;
    each([&](const std::uint32_t& free) { first = std::max(first, free); });
    while (first < used.size() && used[first] >= longest) ++first;
    if (used.size() <= first) used.resize(first + 1, 0);
    ++used[first];
    batch[i] = first;
    each([&](std::uint32_t& free) { free = first + 1; });
  }
  return batch;
}

namespace {

class OcclusionMap final : public Culler {
 public:
  OcclusionMap(const IndexedScene& scene, const OcclusionStageConfig& config, int batch, bool use_map)
      : stage_(scene, config), longest_(static_cast<std::uint32_t>(batch)), use_map_(use_map) {}

  void cull(const View& view, const VisibleSet& candidates, VisibleSet& visible, Counters& counters) override {
    visible.reset(candidates.universe());
    stage_.begin(view, candidates, counters);
    map_.reset(stage_.width(), stage_.height());
    order_batches();
    for (std::size_t begin = 0; begin < order_.size();) {
      std::size_t end = begin;
      while (end < order_.size() && batch_[order_[end]] == batch_[order_[begin]]) ++end;
      run_batch(begin, end, visible, counters);
      begin = end;
    }
    stage_.end(counters);
  }

  bool follow_scene() override {
    stage_.follow_scene();
    return true;
  }

 private:
  void order_batches() {
    rectangles_.clear();
    for (const StagedObject& object : stage_.objects()) rectangles_.push_back(object.footprint);
    batch_ = overlap_free_batches(rectangles_, longest_);
    order_.resize(batch_.size());
    for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
    std::stable_sort(order_.begin(), order_.end(), [&](auto a, auto b) { return batch_[a] < batch_[b]; });
  }

  /// First all tests of the batch, then all its drawing.
  void run_batch(std::size_t begin, std::size_t end, VisibleSet& visible, Counters& counters) {
    drawn_.clear();
    bool asked = false;
    const auto seen = [&](std::span<const Occludee> boxes) {
      return std::any_of(boxes.begin(), boxes.end(), [&](const Occludee& box) {
        const BoxFootprint& f = box.footprint;
        if (use_map_ && !map_.covers(f.x0, f.y0, f.x1, f.y1, counters.cells_tested)) {
          ++counters.queries_saved;
          return true;
        }
        ++counters.queries;
        asked = true;
        return stage_.buffer().may_be_seen(box.bounds);
      });
    };
    for (std::size_t i = begin; i < end; ++i) {
      const StagedObject& object = stage_.objects()[order_[i]];
      if (!stage_.may_be_seen(object, seen)) continue;
      visible.insert(object.id);
      drawn_.push_back(order_[i]);
    }
    counters.query_batches += asked ? 1 : 0;
    for (const std::uint32_t i : drawn_)
      if (stage_.draw(stage_.objects()[i])) occupy(stage_.objects()[i].footprint);
  }

  void occupy(const BoxFootprint& f) {
    for (int y = f.y0; y < f.y1; ++y)
      for (int x = f.x0; x < f.x1; ++x)
        if (!map_.full(0, x, y) && std::isfinite(stage_.buffer().hidden_beyond(x, y))) map_.occupy(x, y);
  }

  OcclusionStage stage_;
  OccupancyMap map_;
  std::uint32_t longest_;
  bool use_map_;
  std::vector<BoxFootprint> rectangles_;
  std::vector<std::uint32_t> batch_, order_, drawn_;
};

}  // namespace

std::unique_ptr<Culler> make_occlusion_map(const IndexedScene& scene, ParameterReader& parameters) {
  OcclusionStageConfig config;
  int batch = 80;
  bool map = true;
  read_stage(parameters, config);
  parameters.read("batch", batch, 1, 4096);
  parameters.read("map", map);
  parameters.finish();
  return std::make_unique<OcclusionMap>(scene, config, batch, map);
}

}  // namespace sightline
