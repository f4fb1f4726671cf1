// Scene files into scenes. One file per format beside this one; the format is told by the file's extension.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "sightline/scene/scene.hpp"
#include "sightline/scene/view.hpp"

namespace sightline {

struct LoadedScene {
  Scene scene;
  /// One line for each thing that the file has and we do not use.
  std::vector<std::string> warnings;
  /// Cameras of the file, named, in world space.
  struct NamedView {
    std::string name;
    View view;
  };
  std::vector<NamedView> cameras;
  /// Those of them that an animation of the file moves: the view at a time from `begin` to `end`, seconds. May be
  /// called from any thread. Throws InputError where the camera is no view at that time.
  struct MovingView {
    std::string name;
    double begin = 0.0, end = 0.0;
    std::function<View(double seconds)> at;
  };
  std::vector<MovingView> moving_cameras;
};

/// Reads .glb, .gltf, .obj and the other formats of docs/formats.md. Throws InputError (file, position, reason) for a
/// file that is missing, broken, or asks for what we cannot do; never reads outside the file, never half a scene.
LoadedScene load_scene(const std::filesystem::path& file);

}  // namespace sightline
