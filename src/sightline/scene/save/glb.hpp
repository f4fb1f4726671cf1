// Scenes into GLB files (glTF 2.0 binary, no extensions).
#pragma once

#include <filesystem>

#include "sightline/scene/scene.hpp"

namespace sightline {

/// Writes a node for every object, in their order, with its name and matrix; meshes once, however many objects share
/// them. Objects that are not opaque get a material with alphaMode BLEND. Loading the file gives the same objects with
/// the same names, transforms and triangles bit by bit; an object without triangles becomes a node without a mesh.
/// Cells and portals are not kept. The file appears whole or not at all. Throws InputError (path, "", reason) if the
/// file cannot be written or would exceed GLB's 4 GiB.
void save_glb(const Scene& scene, const std::filesystem::path& path);

}  // namespace sightline
