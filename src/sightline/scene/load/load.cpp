// Which reader a scene file gets.
#include "sightline/scene/load/load.hpp"

#include <array>
#include <new>
#include <stdexcept>

#include "sightline/scene/input_error.hpp"
#include "sightline/scene/load/readers.hpp"

namespace sightline {

namespace {

constexpr std::array<std::string_view, 6> assimp_extensions = {".ply", ".stl", ".dae", ".fbx", ".3ds", ".ifc"};

std::string lower_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return extension;
}

LoadedScene dispatch(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  if (extension == ".glb" || extension == ".gltf") return read_gltf(file, read_file(file));
  if (extension == ".obj") return read_obj(file, read_file(file));
  for (const std::string_view known : assimp_extensions) {
    if (extension == known) return read_with_assimp(file);
  }
  throw InputError(file.string(), "",
                   in_quotes(extension) + " is none of .glb .gltf .obj .ply .stl .dae .fbx .3ds .ifc");
}

}  // namespace

LoadedScene load_scene(const std::filesystem::path& file) {
  try {
    return dispatch(file);
  } catch (const InputError& error) {
    if (!error.file().empty()) throw;
    throw InputError(file.string(), error.position(), error.reason());
  } catch (const std::bad_alloc&) {
    throw InputError(file.string(), "", "needs more memory than there is");
  } catch (const std::length_error&) {
    throw InputError(file.string(), "", "needs more memory than there is");
  }
}

}  // namespace sightline
