// Generated scenes: seeded (same config, same scene, bit by bit) and scalable. One file per kind beside this one.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "sightline/scene/scene.hpp"

namespace sightline {

struct GenerateConfig {
  std::uint32_t objects = 1000;  // about so many objects, 1 to 4 million
  std::uint64_t triangles = 0;   // about so many triangles over all instances; 0: what the kind finds natural
  std::uint64_t seed = 1;
};

struct Generator {
  std::string_view name;
  std::string_view summary;  // one line
  Scene (*make)(const GenerateConfig&);
};

/// All kinds, by name.
std::span<const Generator> generators();

/// Throws InputError for an unknown kind or a config out of range.
Scene generate_scene(std::string_view kind, const GenerateConfig& config);

}  // namespace sightline
