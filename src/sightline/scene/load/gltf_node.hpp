// What a glTF node says besides its mesh and children: its place, instances, and the camera it carries.
// Source: glTF 2.0 specification, sections 3.5.3 and 3.10; EXT_mesh_gpu_instancing.
#pragma once

#include <optional>
#include <vector>

#include "sightline/scene/load/gltf_document.hpp"
#include "sightline/scene/view.hpp"

namespace sightline {

/// The transform of a node relative to its parent: its matrix, or its translation, rotation and scale. Throws
/// InputError.
glm::dmat4 node_matrix(const JsonObject& node);

/// How many instances the node says it has (EXT_mesh_gpu_instancing); 1 if it has no such extension. Throws InputError.
std::uint64_t instance_count(const GltfDocument& document, const JsonObject& node);

/// Where the instances of a node lie relative to it (EXT_mesh_gpu_instancing); one identity if it has no such
/// extension. Throws InputError.
std::vector<glm::dmat4> instance_matrices(GltfDocument& document, const JsonObject& node);

/// The camera as a view of 720 lines, wide as its aspect ratio asks (16 : 9 if it does not). Scale in `world` is
/// ignored. Throws InputError if a value is out of its range.
View camera_view(const JsonObject& camera, const glm::dmat4& world);

/// `lens` where its camera stands and looks in `world`. Throws InputError without a file if that is no view.
View moved_view(const View& lens, const glm::dmat4& world);

}  // namespace sightline
