// The SCENE of the command line: a file, or "generate:KIND[:objects=N][:triangles=N][:seed=N]".
#pragma once

#include <string_view>

#include "options.hpp"
#include "sightline/scene/input_error.hpp"
#include "sightline/scene/load/load.hpp"

namespace sightline::cli {

/// Loads or generates. The seed of a generated scene is common.seed unless the text has its own. Warnings of the reader
/// go to standard error unless common.quiet; with common.strict they are errors. Throws UsageError for a generator or
/// parameter that does not exist, InputError for a file that cannot be read.
LoadedScene open_scene(std::string_view text, const CommonOptions& common);

/// The largest numbers that `--objects` and `--triangles` take.
inline constexpr std::uint64_t most_objects = 4'000'000;
inline constexpr std::uint64_t most_triangles = 1'000'000'000'000;

/// Runs `make` (something that reads a value from the command line) and turns its InputError into a UsageError.
template <class F>
auto as_usage(F&& make) {
  try {
    return make();
  } catch (const InputError& error) {
    throw UsageError(error.what());
  }
}

}  // namespace sightline::cli
