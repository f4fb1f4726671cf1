// From camera options and a scene to views: default planes, and the paths that a walk follows.
#pragma once

#include "options.hpp"
#include "sightline/scene/camera_path.hpp"
#include "sightline/scene/load/load.hpp"

namespace sightline::cli {

/// A view with the projection and viewport of the options. Without --near the near plane follows from the diagonal of
/// the scene (1e-4 of it, 0.01 to 0.1 m); without --far the far plane lies two diagonals away. Throws UsageError.
View prototype_view(const CameraOptions& options, const Scene& scene);

/// Moves the far plane of `view` so that it holds all of the scene, unless --far was given.
void contain_scene(View& view, const CameraOptions& options, const Scene& scene);

/// The views of --path, or the generated walk; without --far all share one far plane that contains the scene from every
/// eye (views of a file that state their own keep it). Throws UsageError for bad options, InputError for a bad path
/// file.
CameraPath open_path(const PathOptions& path, const CameraOptions& options, const Scene& scene, std::uint64_t seed);

/// The same for a scene from a file, whose cameras may be the path: "camera" is the first that the file moves, or all
/// that stand, one after the other; "camera:NAME" the one of that name. Views keep their lens and planes but not their
/// size.
CameraPath open_path(const PathOptions& path, const CameraOptions& options, const LoadedScene& loaded,
                     std::uint64_t seed);

/// The view from `eye` along `look` that holds the scene between its planes. Throws UsageError.
View placed_view(const glm::dvec3& eye, const glm::dvec3& look, const CameraOptions& options, const Scene& scene);

/// The one view of a verb that takes --eye and --look, or --frame of --path. Throws UsageError or InputError.
View single_view(const ViewOptions& options, const LoadedScene& loaded, std::uint64_t seed);

}  // namespace sightline::cli
