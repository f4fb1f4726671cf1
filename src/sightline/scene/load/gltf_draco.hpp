// Triangles compressed by KHR_draco_mesh_compression, decoded by Google's Draco.
// Promise: indices lie within the positions, positions are finite.
// Source: the extension's specification, Khronos extension of glTF 2.0.
#pragma once

#include <cstdint>
#include <span>

#include "sightline/scene/load/json_object.hpp"
#include "sightline/scene/scene.hpp"

namespace sightline {

/// The mesh in `compressed`, whose attribute with the unique id `position` has the positions. Throws InputError at
/// `extension` if the data is broken.
Mesh decode_draco(const JsonObject& extension, std::span<const std::byte> compressed, std::uint32_t position);

}  // namespace sightline
