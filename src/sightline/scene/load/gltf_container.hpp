// The outer layers of a glTF 2.0 file: GLB chunks, base64 data URIs, and URIs of files beside the scene.
// Source: glTF 2.0 specification, sections 2.8 (URIs) and 4 (GLB). All throw InputError.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "sightline/scene/load/file_bytes.hpp"

namespace sightline {

/// The two chunks of a GLB as parts of its bytes; a .gltf is JSON alone.
struct GltfChunks {
  std::span<const std::byte> json;
  std::optional<std::span<const std::byte>> binary;
};

/// Takes `bytes` apart: a GLB if they begin with "glTF", otherwise all of them are JSON.
GltfChunks split_gltf(const std::string& file, std::span<const std::byte> bytes);

/// The bytes of "data:...;base64,..."; nothing if `uri` is no data URI. `place` is for the message.
std::optional<Bytes> decode_data_uri(std::string_view uri, const std::string& file, const std::string& place);

/// The file that a relative URI means (%20 and the like decoded), always inside the folder of `file`: absolute paths,
/// ".." that lead out, and other schemes are refused.
std::filesystem::path resolve_uri(std::string_view uri, const std::string& file, const std::string& place);

}  // namespace sightline
