// The frames loop of a walk: cull, look, judge.
#pragma once

#include <span>

#include "options.hpp"
#include "sightline/core/algorithm.hpp"
#include "sightline/oracle/oracle.hpp"
#include "walk_report.hpp"

namespace sightline::cli {

/// Fills report.views and report.runs: every method answers every view, all are judged by one truth for each view (none
/// if oracle is null). report.scene must be set. Ends early, with report.interrupted set, on Ctrl-C. Throws UsageError
/// for a method that does not exist.
void walk_frames(const WalkOptions& options, const IndexedScene& indexed, std::span<const View> views,
                 const Oracle* oracle, WalkReport& report);

/// About six frames of the walk, those with the most missed among them, each shaded, by object and by depth.
std::vector<WalkPicture> draw_pictures(const WalkReport& report, const Oracle& oracle);

}  // namespace sightline::cli
