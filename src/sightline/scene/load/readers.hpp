// The readers behind load_scene, read_path and read_cameras, one per family of formats, for bytes that are in memory already.
#pragma once

#include <filesystem>

#include "sightline/scene/calibrated_camera.hpp"
#include "sightline/scene/camera_path.hpp"
#include "sightline/scene/load/file_bytes.hpp"
#include "sightline/scene/load/load.hpp"

namespace sightline {

/// glTF 2.0 as JSON or GLB. `file` names the bytes in messages; external buffers are read from its folder.
/// Throws InputError.
LoadedScene read_gltf(const std::filesystem::path& file, Bytes bytes);

/// Wavefront OBJ; its material files are read from the folder of `file`. Throws InputError.
LoadedScene read_obj(const std::filesystem::path& file, const Bytes& bytes);

/// PLY, STL, DAE, FBX, 3DS and IFC. Throws InputError.
LoadedScene read_with_assimp(const std::filesystem::path& file);

/// What read_path does, for the content of `file`. Throws InputError.
CameraPath parse_path(const std::filesystem::path& file, const Bytes& bytes, const PathConfig& config);

/// What read_cameras does, for the content of `file`. Throws InputError.
std::vector<CalibratedCamera> parse_cameras(const std::filesystem::path& file, const Bytes& bytes);

}  // namespace sightline
