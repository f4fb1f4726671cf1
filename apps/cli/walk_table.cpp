#include "walk_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace sightline::cli {
namespace {

std::string number_or_dash(const std::optional<std::size_t>& value) { return value ? fmt::to_string(*value) : "-"; }

std::string fixed_or_dash(const std::optional<double>& value, int digits, double scale = 1.0) {
  return value ? fmt::format("{:.{}f}", *value * scale, digits) : "-";
}

std::string frame_rows(const WalkReport& report, const WalkRun& run) {
  std::string text =
      fmt::format("{:>6} {:>10} {:>9} {:>9} {:>9} {:>7} {:>9} {:>10} {:>9} {:>13}\n", "frame", "candidates", "frustum",
                  "visible", "truth", "missed", "extra", "cull ms", "truth ms", "triangles");
  for (std::size_t i = 0; i < run.answers.size(); ++i) {
    const WalkView& view = report.views[i];
    const WalkAnswer& answer = run.answers[i];
    const bool verified = view.truth.has_value();
    fmt::format_to(std::back_inserter(text), "{:>6} {:>10} {:>9} {:>9} {:>9} {:>7} {:>9} {:>10.3f} {:>9} {:>13}\n",
                   view.frame, view.candidates, view.frustum, answer.visible, number_or_dash(view.truth),
                   verified ? fmt::to_string(answer.missed.size()) : "-", verified ? fmt::to_string(answer.extra) : "-",
                   answer.cull_ms, verified ? fmt::format("{:.1f}", view.truth_ms) : "-", answer.triangles_submitted);
  }
  return text;
}

std::string method_rows(const WalkReport& report) {
  std::size_t width = 6;
  for (const WalkRun& run : report.runs) width = std::max(width, run.method.size());
  std::string text = fmt::format("{:<{}}  {:<23} {:>9} {:>7} {:>12} {:>10} {:>12}  {}\n", "method", width, "promise",
                                 "visible", "missed", "overestimate", "cull ms", "triangles %", "verdict");
  for (const WalkRun& run : report.runs) {
    const WalkSummary summary = summarise(report, run);
    std::size_t visible = 0;
    for (const WalkAnswer& answer : run.answers) visible += answer.visible;
    const double mean =
        static_cast<double>(visible) / static_cast<double>(std::max<std::size_t>(run.answers.size(), 1));
    fmt::format_to(std::back_inserter(text), "{:<{}}  {:<23} {:>9.1f} {:>7} {:>12} {:>10} {:>12}  {}\n", run.method,
                   width, to_string(run.promise), mean, number_or_dash(summary.missed),
                   fixed_or_dash(summary.overestimate, 2), fixed_or_dash(summary.cull_ms_median, 3),
                   fixed_or_dash(summary.triangles_fraction, 2, 100.0), summary.verdict);
  }
  return text;
}

}  // namespace

std::string walk_table(const WalkReport& report) {
  return report.runs.size() == 1 ? frame_rows(report, report.runs.front()) : method_rows(report);
}

}  // namespace sightline::cli
