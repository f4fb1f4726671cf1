#include "sightline/scene/generate/generate.hpp"

#include <string>

#include "sightline/scene/generate/kinds.hpp"
#include "sightline/scene/input_error.hpp"

namespace sightline {
namespace {

constexpr std::uint32_t most_objects = 4'000'000;
constexpr std::uint64_t most_triangles = 10'000'000'000;

constexpr Generator kinds[] = {
    {"building", "storeys of rooms along corridors, with doors, windows, furniture, cells and portals",
     generate_building},
    {"city", "blocks of houses and towers along streets, with trees, cars and back yards", generate_city},
    {"forest", "trees, bushes and stones on hills: much is hidden by many things of which each hides little",
     generate_forest},
    {"layers", "parallel walls that cover the view, small things between: depth complexity by construction",
     generate_layers},
    {"plant", "pipe racks, tanks, steel structures, vessels and pumps: thin things without number", generate_plant},
    {"soup", "triangles, slivers, boxes and balls of all sizes, anywhere, through each other; for tests",
     generate_soup},
};

}  // namespace

std::span<const Generator> generators() { return kinds; }

Scene generate_scene(std::string_view kind, const GenerateConfig& config) {
  if (config.objects < 1 || config.objects > most_objects)
    throw InputError("objects must be 1 to " + std::to_string(most_objects) + ", not " +
                     std::to_string(config.objects));
  if (config.triangles > most_triangles)
    throw InputError("triangles must be at most " + std::to_string(most_triangles) + ", not " +
                     std::to_string(config.triangles));
  std::string names;
  for (const Generator& generator : kinds) {
    if (generator.name == kind) return generator.make(config);
    names += (names.empty() ? "" : ", ") + std::string(generator.name);
  }
  throw InputError("there is no kind of scene called '" + std::string(kind) + "'; there are " + names);
}

}  // namespace sightline
