// Camera paths: sequences of views that share projection and viewport.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "sightline/scene/scene.hpp"
#include "sightline/scene/view.hpp"

namespace sightline {

struct CameraPath {
  std::vector<View> views;
};

/// How views are made that the source of a path leaves open.
struct PathConfig {
  int frames = 120;  // number of views, >= 1
  View prototype{};  // projection, near, far and viewport of every view
  std::uint64_t seed = 1;
};

/// A smooth walk through free space: between surfaces, not through them, at about eye height above a floor where the
/// scene has one, looking mostly along the way. Throws InputError if the scene is empty.
CameraPath generate_path(const Scene& scene, const PathConfig& config);

/// Views made to break algorithms, in turn: jumps to far places, turns on the spot, eyes that touch a surface (within
/// the near plane's distance), eyes within the bounds of objects and within objects, far away, straight up and down.
/// Next views have nothing in common. Same config, same views. Throws InputError if the scene is empty.
CameraPath stress_path(const Scene& scene, const PathConfig& config);

/// `frames` views from a file of eyes.
/// Text, one view a line: "x y z" (the eye) or "x y z dx dy dz" (eye and look direction); further words and '#'
/// comments are ignored, and there is a direction only where the fourth to the sixth word are all numbers. A direction
/// of length 0 is that of the line before. JSON: {"views":[{"eye":[x,y,z],"look":[dx,dy,dz] or
/// "target":[x,y,z],"up":[x,y,z],"fov":degrees,"near":m,"far":m}]}, all but the eye optional. An eye without direction
/// is shown turning once about the vertical axis over the frames it gets. With more frames than lines, a line is shown
/// for several frames; with fewer, lines are skipped evenly. Throws InputError (file, line or field, reason).
CameraPath read_path(const std::filesystem::path& file, const PathConfig& config);

}  // namespace sightline
