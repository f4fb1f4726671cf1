#include "comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "sightline/registry.hpp"

namespace sightline::cli {
namespace {

/// Counts the depth tests of frames: the answers of evenly spread ones are drawn at a quarter of the size.
class PixelCounter {
 public:
  explicit PixelCounter(const WalkReport& report)
      : report_(report), indexed_(index_scene(*report.scene)), renderer_(make_renderer("zbuffer", indexed_)) {}

  /// Mean for each frame; absent if a frame has too many triangles to be drawn for a statistic.
  std::optional<double> mean(const WalkRun& run) {
    constexpr std::size_t wanted = 3;
    constexpr std::uint64_t most_triangles = 3'000'000;
    const std::size_t total = run.answers.size(), count = std::min(wanted, total);
    if (count == 0) return std::nullopt;
    double pixels = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = (2 * k + 1) * total / (2 * count);
      if (run.answers[i].triangles_submitted > most_triangles) return std::nullopt;
      pixels += draw(report_.views[i].view, run.answers[i].visible_ids);
    }
    return pixels / static_cast<double>(count);
  }

 private:
  double draw(View view, const std::vector<ObjectId>& ids) {
    const double full = static_cast<double>(view.width) * view.height;
    view.width = std::max(1, view.width / 4);
    view.height = std::max(1, view.height / 4);
    VisibleSet visible(report_.scene->objects().size());
    for (const ObjectId id : ids) visible.insert(id);
    Counters counters;
    renderer_->draw(view, visible, frame_, counters);
    return static_cast<double>(counters.pixels_tested) * full / (static_cast<double>(view.width) * view.height);
  }

  const WalkReport& report_;
  IndexedScene indexed_;
  std::unique_ptr<Renderer> renderer_;
  Frame frame_;
};

double mean_bytes(const WalkReport& report, const WalkRun& run) {
  double bytes = 0;
  for (const WalkAnswer& answer : run.answers)
    for (const ObjectId id : answer.visible_ids) {
      const Mesh& mesh = report.scene->mesh_of(id);
      bytes +=
          static_cast<double>(mesh.positions.size() * sizeof(glm::vec3) + mesh.triangles.size() * sizeof(glm::uvec3));
    }
  return bytes;
}

ComparedMethod compare_run(const WalkReport& report, const WalkRun& run, const UnitCosts& units, PixelCounter& pixels) {
  const WalkSummary summary = summarise(report, run);
  ComparedMethod row;
  row.method = run.method;
  row.promise = to_string(run.promise);
  row.verdict = summary.verdict;
  row.broken = summary.broken_promise;
  row.missed = summary.missed.value_or(0);
  row.median_ms = summary.cull_ms_median.value_or(0.0);
  row.memory_bytes = run.memory_bytes;
  const double frames = static_cast<double>(std::max<std::size_t>(run.answers.size(), 1));
  double candidates = 0, visible = 0, hidden = 0, found = 0, triangles = 0;
  for (std::size_t i = 0; i < run.answers.size(); ++i) {
    const WalkView& view = report.views[i];
    const WalkAnswer& answer = run.answers[i];
    candidates += static_cast<double>(view.candidates);
    visible += static_cast<double>(answer.visible);
    triangles += static_cast<double>(answer.triangles_submitted);
    row.extra += static_cast<double>(answer.extra) / frames;
    row.lost_pixels += answer.missed_samples;
    row.worst_pixels = std::max(row.worst_pixels, answer.missed_samples);
    const double truth = static_cast<double>(view.truth.value_or(0)), frustum = static_cast<double>(view.frustum);
    const double seen = truth - static_cast<double>(answer.missed.size());  // of what is reported
    hidden += std::max(0.0, frustum - truth);
    found += std::max(0.0, frustum - truth - (static_cast<double>(answer.visible) - seen));
  }
  row.culled = candidates > 0 ? 1 - visible / candidates : 0.0;
  if (hidden > 0) row.found = found / hidden;
  run.counters.each([&](const char* name, std::uint64_t value) {
    if (value > 0) row.counters[name] = static_cast<double>(value) / frames;
  });
  row.costs =
      stage_costs({row.median_ms, triangles / frames, pixels.mean(run), mean_bytes(report, run) / frames}, units);
  return row;
}

std::string bytes_text(std::size_t bytes) {
  if (bytes == 0) return "-";
  return bytes < 10'000'000 ? fmt::format("{:.2f}", 1e-6 * static_cast<double>(bytes))
                            : fmt::format("{:.0f}", 1e-6 * static_cast<double>(bytes));
}

}  // namespace

Comparison compare_walk(const WalkReport& report) {
  Comparison comparison;
  comparison.units = measure_unit_costs();
  PixelCounter pixels(report);
  for (const WalkRun& run : report.runs)
    comparison.methods.push_back(compare_run(report, run, comparison.units, pixels));
  return comparison;
}

std::string comparison_table(const Comparison& comparison) {
  std::size_t width = 6;
  for (const ComparedMethod& row : comparison.methods) width = std::max(width, row.method.size());
  std::string text =
      fmt::format("{:<{}}  {:<23} {:>9} {:>8} {:>7} {:>14} {:>11} {:>10} {:>10}  {}\n", "method", width, "promise",
                  "culled %", "found %", "missed", "false-visible", "lost pixels", "median ms", "memory MB", "verdict");
  const auto out = [&] { return std::back_inserter(text); };
  for (const ComparedMethod& row : comparison.methods)
    fmt::format_to(out(), "{:<{}}  {:<23} {:>9.2f} {:>8} {:>7} {:>14.1f} {:>11} {:>10.3f} {:>10}  {}\n", row.method,
                   width, row.promise, 100 * row.culled, row.found ? fmt::format("{:.2f}", 100 * *row.found) : "-",
                   row.missed, row.extra, row.lost_pixels, row.median_ms, bytes_text(row.memory_bytes), row.verdict);
  fmt::format_to(
      out(), "\ncost model, ms a frame (software renderer: {:.1f} ns a triangle, {:.2f} ns a pixel; bus {:.2f} GB/s)\n",
      1e6 * comparison.units.per_triangle, 1e6 * comparison.units.per_pixel,
      comparison.units.per_byte > 0 ? 1e-6 / comparison.units.per_byte : 0.0);
  fmt::format_to(out(), "{:<{}}  {:>12} {:>12} {:>12} {:>12}  {}\n", "method", width, "application", "geometry", "fill",
                 "bus", "limited by");
  for (const ComparedMethod& row : comparison.methods)
    fmt::format_to(out(), "{:<{}}  {:>12.3f} {:>12.3f} {:>12} {:>12.3f}  {}\n", row.method, width,
                   row.costs.application_ms, row.costs.geometry_ms,
                   row.costs.fill_ms ? fmt::format("{:.3f}", *row.costs.fill_ms) : "-", row.costs.bus_ms,
                   row.costs.limiting);
  return text;
}

Json comparison_json(const Comparison& comparison) {
  Json json{{"units",
             {{"ms_per_triangle", comparison.units.per_triangle},
              {"ms_per_pixel", comparison.units.per_pixel},
              {"ms_per_byte", comparison.units.per_byte}}},
            {"methods", Json::array()}};
  for (const ComparedMethod& row : comparison.methods) {
    Json counters = Json::object();
    for (const auto& [name, value] : row.counters) counters[name] = value;
    json["methods"].push_back({{"method", row.method},
                               {"promise", row.promise},
                               {"verdict", row.verdict},
                               {"broken", row.broken},
                               {"culled", row.culled},
                               {"found", row.found ? Json(*row.found) : Json(nullptr)},
                               {"missed", row.missed},
                               {"false_visible", row.extra},
                               {"lost_pixels", row.lost_pixels},
                               {"worst_frame_lost_pixels", row.worst_pixels},
                               {"cull_ms_median", row.median_ms},
                               {"memory_bytes", row.memory_bytes == 0 ? Json(nullptr) : Json(row.memory_bytes)},
                               {"counters_per_frame", counters},
                               {"stages_ms",
                                {{"application", row.costs.application_ms},
                                 {"geometry", row.costs.geometry_ms},
                                 {"fill", row.costs.fill_ms ? Json(*row.costs.fill_ms) : Json(nullptr)},
                                 {"bus", row.costs.bus_ms}}},
                               {"limited_by", row.costs.limiting}});
  }
  return json;
}

}  // namespace sightline::cli
