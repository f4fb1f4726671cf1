// The rows of `sightline compare`: what a walk of several methods amounts to, method by method.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "cost_model.hpp"
#include "json.hpp"
#include "walk_report.hpp"

namespace sightline::cli {

/// Means are over the frames of the walk.
struct ComparedMethod {
  std::string method, promise, verdict;
  double culled = 0;               // share of all objects that is culled
  std::optional<double> found;     // of the objects in the frustum that are hidden, the share that is culled
  std::size_t missed = 0;          // seen but not reported (false-invisible), each frame counted
  double extra = 0;                // reported but not seen (false-visible) in a frame
  std::uint64_t lost_pixels = 0;   // samples through which missed objects are seen
  std::uint64_t worst_pixels = 0;  // the same of the worst frame
  double median_ms = 0;
  std::size_t memory_bytes = 0;            // 0: not known
  std::map<std::string, double> counters;  // for each frame
  StageCosts costs;
  bool broken = false;
};

struct Comparison {
  UnitCosts units;
  std::vector<ComparedMethod> methods;
};

/// From a verified walk whose answers hold visible ids. Draws some of the frames to count pixels.
Comparison compare_walk(const WalkReport& report);

std::string comparison_table(const Comparison& comparison);
Json comparison_json(const Comparison& comparison);

}  // namespace sightline::cli
