// Buffer views compressed by EXT_meshopt_compression, decoded by meshoptimizer.
// Promise: sizes are checked against what meshoptimizer's decoders ask for before they run.
// Source: the extension's specification, vendor extension of glTF 2.0.
#pragma once

#include <span>

#include "sightline/scene/load/file_bytes.hpp"
#include "sightline/scene/load/json_object.hpp"

namespace sightline {

/// How many bytes the view will have: count * byteStride. Throws InputError if the extension object asks for what the
/// format does not allow.
std::uint64_t meshopt_size(const JsonObject& extension);

/// The bytes of the view. `compressed` is what the extension object points to. Throws InputError if it is broken.
Bytes decode_meshopt(const JsonObject& extension, std::span<const std::byte> compressed);

}  // namespace sightline
