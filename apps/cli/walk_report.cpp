#include "walk_report.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace sightline::cli {
namespace {

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

void judge_run(const WalkReport& report, const WalkRun& run, WalkSummary& summary) {
  if (!report.verified || run.answers.empty()) {
    summary.verdict = "unverified";
    return;
  }
  std::size_t visible = 0, truth = 0, missed = 0, unpromised = 0;
  for (std::size_t i = 0; i < run.answers.size(); ++i) {
    visible += run.answers[i].visible;
    truth += report.views[i].truth.value_or(0);
    missed += run.answers[i].missed.size();
    unpromised += run.answers[i].unpromised;
  }
  summary.missed = missed;
  if (truth > 0) summary.overestimate = static_cast<double>(visible) / static_cast<double>(truth);
  if (missed == 0) {
    summary.verdict = "ok";
  } else if (run.promise == Promise::approximate) {
    summary.verdict = fmt::format("approximate: {} missed", missed);
  } else if (missed == unpromised) {
    summary.verdict = fmt::format("ok at pixel centres: {} missed", missed);
  } else {
    summary.verdict = "missed";
    summary.broken_promise = true;
  }
}

std::size_t distinct_missed(const WalkRun& run) {
  std::vector<ObjectId> ids;
  for (const WalkAnswer& answer : run.answers) ids.insert(ids.end(), answer.missed.begin(), answer.missed.end());
  std::sort(ids.begin(), ids.end());
  return static_cast<std::size_t>(std::unique(ids.begin(), ids.end()) - ids.begin());
}

/// The error measure of approximate methods: pixels (samples) whose nearest surface was dropped.
std::string lost_words(const WalkReport& report, const WalkRun& run) {
  std::uint64_t lost = 0, worst = 0;
  for (const WalkAnswer& answer : run.answers) {
    lost += answer.missed_samples;
    worst = std::max(worst, answer.missed_samples);
  }
  const double samples = static_cast<double>(report.width) * report.height * report.samples * report.samples;
  return fmt::format(", {:.1f} of {:.0f} pixels lost a frame, at most {}",
                     static_cast<double>(lost) / static_cast<double>(std::max<std::size_t>(run.answers.size(), 1)),
                     samples, worst);
}

const char* missed_title(const WalkSummary& summary, const WalkRun& run) {
  if (summary.broken_promise) return "MISSED";
  return run.promise == Promise::approximate ? "approximate" : "ok at pixel centres";
}

std::string missed_words(const WalkReport& report, const WalkRun& run) {
  std::size_t frames = 0, first = 0, missed = 0;
  for (std::size_t i = run.answers.size(); i-- > 0;) {
    missed += run.answers[i].missed.size();
    if (run.answers[i].missed.empty()) continue;
    ++frames;
    first = i;
  }
  std::string words = fmt::format(
      "{} times something visible was missed ({} objects in {} of {} frames, first object {} in frame {})", missed,
      distinct_missed(run), frames, run.answers.size(), run.answers[first].missed.front(), report.views[first].frame);
  if (run.promise == Promise::approximate) words += lost_words(report, run);
  if (report.samples > 1 && run.promise != Promise::conservative_continuous)
    words += fmt::format(" by {0} x {0} rays a pixel, where the promise is for pixel centres", report.samples);
  return words;
}

}  // namespace

WalkSummary summarise(const WalkReport& report, const WalkRun& run) {
  WalkSummary summary;
  judge_run(report, run, summary);
  if (run.answers.empty()) return summary;
  std::vector<double> times, following;
  double submitted = 0.0;
  for (const WalkAnswer& answer : run.answers) {
    times.push_back(answer.cull_ms);
    following.push_back(answer.follow_ms);
    submitted += static_cast<double>(answer.triangles_submitted);
  }
  summary.cull_ms_median = median(std::move(times));
  following.erase(following.begin());  // nothing has moved yet
  if (report.moving > 0 && !following.empty()) summary.follow_ms_median = median(std::move(following));
  const double triangles = static_cast<double>(report.scene->triangle_count());
  if (triangles > 0.0) summary.triangles_fraction = submitted / static_cast<double>(run.answers.size()) / triangles;
  return summary;
}

std::optional<double> move_ms_median(const WalkReport& report) {
  std::vector<double> times;
  for (std::size_t i = 1; report.moving > 0 && i < report.views.size(); ++i) times.push_back(report.views[i].move_ms);
  if (times.empty()) return std::nullopt;
  return median(std::move(times));
}

ExitCode exit_code(const WalkReport& report) {
  for (const WalkRun& run : report.runs)
    if (summarise(report, run).broken_promise) return exit_missed;
  return report.interrupted ? exit_interrupted : exit_ok;
}

std::string verdict_line(const WalkReport& report, const WalkRun& run) {
  const WalkSummary summary = summarise(report, run);
  std::string line = fmt::format("{}: ", run.method);
  if (summary.verdict == "unverified")
    line += fmt::format("unverified, {} frames", run.answers.size());
  else if (summary.missed.value_or(0) > 0)
    line += fmt::format("{}: {}", missed_title(summary, run), missed_words(report, run));
  else
    line += fmt::format("ok: nothing visible was missed in {} frames", run.answers.size());
  if (summary.overestimate) line += fmt::format("; {:.2f} objects reported per object seen", *summary.overestimate);
  if (summary.triangles_fraction)
    line += fmt::format("; {:.1f} % of the triangles", 100.0 * *summary.triangles_fraction);
  if (summary.cull_ms_median) line += fmt::format("; median {:.3f} ms", *summary.cull_ms_median);
  if (summary.follow_ms_median)
    line += fmt::format("; {} in {:.3f} ms", run.made_anew ? "made anew" : "followed", *summary.follow_ms_median);
  if (report.interrupted) line += "; interrupted";
  return line;
}

}  // namespace sightline::cli
