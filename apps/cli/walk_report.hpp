// What a walk found: one set of views and truths, and for each method its answers to them. Plain data and its sums.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "options.hpp"
#include "sightline/core/algorithm.hpp"
#include "sightline/core/counters.hpp"
#include "sightline/scene/scene.hpp"
#include "sightline/scene/view.hpp"

namespace sightline::cli {

/// What holds for a view whatever the method.
struct WalkView {
  std::size_t frame = 0;
  View view;
  std::size_t candidates = 0;        // objects given to the culler
  std::size_t frustum = 0;           // of those, kept by the linear frustum test
  std::optional<std::size_t> truth;  // objects seen; absent without verification
  double truth_ms = 0.0;
  double move_ms = 0.0;  // moving objects and refitting the index over them
};

/// What one method said about one view.
struct WalkAnswer {
  std::size_t visible = 0;                // objects reported
  std::vector<ObjectId> missed;           // seen but not reported, ascending
  std::size_t unpromised = 0;             // of the missed: those that the method does not promise to find
  std::uint64_t missed_samples = 0;       // samples through which those are seen
  std::size_t extra = 0;                  // reported but not seen
  double cull_ms = 0.0;                   // cull() alone
  double follow_ms = 0.0;                 // follow_scene(), or making the culler anew
  std::uint64_t triangles_submitted = 0;  // triangles of the objects reported
  std::vector<ObjectId> visible_ids;      // ascending; only with --ids, or for the pictures of a report
  std::vector<std::uint8_t> state;        // one ObjectState per object; only of frames that the report shows
};

/// What became of an object in a frame (the report colours by it).
enum class ObjectState : std::uint8_t { outside = 0, hidden = 1, seen = 2, extra = 3, missed = 4 };

struct WalkRun {
  std::string method;  // as given, with its parameters
  Promise promise = Promise::exact;
  std::vector<WalkAnswer> answers;  // parallel to WalkReport::views
  Counters counters;                // over all frames
  bool made_anew = false;           // for frames in which objects moved, as it cannot follow
  std::size_t memory_bytes = 0;     // that the culler allocated; 0 where the allocator does not tell
};

/// A picture of a frame, for the report.
struct WalkPicture {
  std::size_t frame = 0;
  std::string kind;  // "shaded", "object", "depth", "overdraw" (of the first method), "overdraw of METHOD"
  std::string png;   // the bytes of the file
};

struct WalkReport {
  std::string scene_name;
  std::string command;
  std::vector<std::string> warnings;  // what the scene file has and is not used
  const Scene* scene = nullptr;       // outlives the report
  int width = 0, height = 0;
  int samples = 1;
  std::size_t moving = 0;  // objects that move
  bool verified = false;
  bool interrupted = false;
  std::vector<WalkView> views;
  std::vector<WalkRun> runs;
  std::vector<WalkPicture> pictures;
  std::string comparison;  // JSON of a comparison of the methods, for the page; empty for none
  std::string trace;       // timeline of the first method that has one, for --trace
};

/// Sums over the frames of one run. An absent value could not be computed (no truth, no frames).
struct WalkSummary {
  std::optional<std::size_t> missed;   // objects missed, each frame counted
  std::optional<double> overestimate;  // objects reported for each object seen
  std::optional<double> cull_ms_median;
  std::optional<double> follow_ms_median;    // of frames in which objects moved
  std::optional<double> triangles_fraction;  // mean share of the scene's triangles that is submitted
  std::string verdict;  // "ok", "missed", "unverified", "approximate: N missed", "ok at pixel centres: N missed"
  /// True if a method that promises to miss nothing missed something.
  bool broken_promise = false;
};

WalkSummary summarise(const WalkReport& report, const WalkRun& run);

/// exit_missed if a promise is broken, else exit_interrupted or exit_ok.
ExitCode exit_code(const WalkReport& report);

/// Of the frames in which objects moved: all but the first. Absent if there are none.
std::optional<double> move_ms_median(const WalkReport& report);

/// One line for a person: the verdict and what it rests on.
std::string verdict_line(const WalkReport& report, const WalkRun& run);

}  // namespace sightline::cli
