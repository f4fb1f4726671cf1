#include "scene_argument.hpp"

#include <fmt/format.h>

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

/// --strict: the first warning as an error, and how many more there are.
[[noreturn]] void refuse_warnings(std::string_view file, const std::vector<std::string>& warnings) {
  const std::size_t more = warnings.size() - 1;
  throw InputError(std::string(file), "",
                   warnings.front() + (more > 0 ? fmt::format(" (and {} more warnings)", more) : ""));
}

}  // namespace

LoadedScene open_scene(std::string_view text, const CommonOptions& common) {
  if (text.starts_with(generate_prefix)) {
    LoadedScene loaded;
    loaded.scene = as_usage([&] { return generate_from_text(text.substr(generate_prefix.size()), common); });
    return loaded;
  }
  Progress progress("load", 1, true);
  LoadedScene loaded = load_scene(std::filesystem::path(text));
  progress.show(1);
  if (common.strict && !loaded.warnings.empty()) refuse_warnings(text, loaded.warnings);
  if (!common.quiet)
    for (const std::string& warning : loaded.warnings) warn(warning);
  return loaded;
}

}  // namespace sightline::cli
