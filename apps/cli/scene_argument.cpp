#include "scene_argument.hpp"

#include "arguments.hpp"
#include "output.hpp"
#include "sightline/core/parameters.hpp"
#include "sightline/scene/generate/generate.hpp"

namespace sightline::cli {
namespace {

constexpr std::string_view generate_prefix = "generate:";

Scene generate_from_text(std::string_view text, const CommonOptions& common) {
  const MethodSpec spec = parse_method(text);
  ParameterReader reader(spec);
  std::string objects, triangles, seed;
  reader.read("objects", objects);
  reader.read("triangles", triangles);
  reader.read("seed", seed);
  reader.finish();
  GenerateConfig config;
  config.seed = common.seed;
  if (!objects.empty()) config.objects = static_cast<std::uint32_t>(parse_whole("objects", objects, 1, most_objects));
  if (!triangles.empty()) config.triangles = parse_whole("triangles", triangles, 0, most_triangles);
  if (!seed.empty()) config.seed = parse_whole("seed", seed, 0, UINT64_MAX);
  return generate_scene(spec.name, config);
}

}  // namespace

LoadedScene open_scene(std::string_view text, const CommonOptions& common) {
  if (text.starts_with(generate_prefix)) {
    LoadedScene loaded;
    loaded.scene = as_usage([&] { return generate_from_text(text.substr(generate_prefix.size()), common); });
    return loaded;
  }
  LoadedScene loaded = load_scene(std::filesystem::path(text));
  if (!common.quiet)
    for (const std::string& warning : loaded.warnings) warn(warning);
  return loaded;
}

}  // namespace sightline::cli
