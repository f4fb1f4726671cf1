// What every fuzz target of a reader does: bytes in; a sound result or an error of one clear line out.
#pragma once

#include <cstdlib>
#include <string>

#include "sightline/scene/input_error.hpp"
#include "sightline/scene/load/readers.hpp"

namespace sightline::fuzz {

inline Bytes bytes_of(const unsigned char* data, std::size_t size) {
  const auto* begin = reinterpret_cast<const std::byte*>(data);
  return {begin, begin + size};
}

/// Calls read(); anything but an InputError of one line ends the program.
template <class Read>
int expect_one_line(Read&& read) {
  try {
    read();
  } catch (const InputError& error) {
    const std::string line = error.what();
    if (line.empty() || line.find('\n') != std::string::npos) std::abort();
  }
  return 0;
}

/// Ends the program if a scene that was read is not sound.
inline void expect_sound(const Scene& scene) {
  for (const Mesh& mesh : scene.meshes())
    for (const glm::uvec3& t : mesh.triangles)
      for (int k = 0; k < 3; ++k)
        if (t[k] >= mesh.positions.size()) std::abort();
  for (const Object& object : scene.objects()) {
    if (object.mesh >= scene.meshes().size()) std::abort();
    if (!object.bounds.empty() && !scene.bounds().contains(object.bounds)) std::abort();
  }
}

}  // namespace sightline::fuzz
