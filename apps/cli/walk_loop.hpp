// The frames loop of a walk: cull, look, judge.
#pragma once

#include <span>

#include "options.hpp"
#include "walk_report.hpp"
#include "walk_scene.hpp"

namespace sightline::cli {

/// Fills report.views and report.runs: every method answers every view, all are judged by one truth for each view (none
/// without options.verify). What moves is brought to each frame first; methods follow or are made anew. report.scene
/// must be set. Ends early, with report.interrupted set, on Ctrl-C. Throws UsageError for a method that does not exist.
void walk_frames(const WalkOptions& options, WalkScene& scene, std::span<const View> views, WalkReport& report);

/// About six frames of the walk, those with the most missed among them, each shaded, by object and by depth.
std::vector<WalkPicture> draw_pictures(const WalkReport& report, WalkScene& scene);

}  // namespace sightline::cli
