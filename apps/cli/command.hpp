// How a verb becomes part of the command line: the options that several verbs share, and the row of a verb. Included by
// main.cpp and by each verb's *_command.cpp, the only files that see CLI11.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "arguments.hpp"
#include "options.hpp"

namespace sightline::cli {

inline constexpr std::uint64_t most_frames = 1'000'000, most_threads = 1024, most_samples = 16;

/// An option whose text goes through read(text), which throws UsageError if it is not as `type` says.
CLI::Option* add_text(CLI::App& app, const std::string& flags, const std::string& type, const std::string& help,
                      const std::string& shown_default, const std::function<void(const std::string&)>& read);

/// A whole number in [low, high].
template <class T>
CLI::Option* add_whole(CLI::App& app, const std::string& flag, const std::string& help, T& value, std::uint64_t low,
                       std::uint64_t high) {
  return add_text(app, flag, "N", help, std::to_string(value), [flag, &value, low, high](const std::string& text) {
    value = static_cast<T>(parse_whole(flag, text, low, high));
  });
}

/// A length of smallest_distance to largest_distance.
CLI::Option* add_metres(CLI::App& app, const std::string& flag, const std::string& help, std::optional<double>& value,
                        bool may_be_infinite = false);

/// A file that the verb writes, whose name must end with `ending`; - for standard output. Its type is FILE, by which
/// check_outputs() knows it.
CLI::Option* add_output(CLI::App& app, const std::string& flags, const std::string& help, std::string& file,
                        const std::string& ending = "");

/// Throws UsageError if an output of the parsed verb would take the place of an input or of another output. True if one
/// of them goes to standard output.
bool check_outputs(const CLI::App& verb);

void add_common(CLI::App& app, CommonOptions& options);
void add_scene(CLI::App& app, std::string& scene);
void add_camera(CLI::App& app, CameraOptions& options);
void add_path(CLI::App& app, PathOptions& options);
/// --eye and --look, or --path, --frames and --frame; and the camera.
void add_view(CLI::App& app, ViewOptions& options);

/// A verb of the program: its place in the command line, and what runs it once its options are read.
struct Verb {
  CLI::App* app;
  CommonOptions* common;
  std::function<int()> run;
};

/// Adds a verb whose options live as long as the returned row. `add` declares the options, `run` returns the exit code.
template <class Options>
Verb add_verb(CLI::App& app, const std::string& name, const std::string& help, void (*add)(CLI::App&, Options&),
              int (*run)(const Options&)) {
  const auto options = std::make_shared<Options>();
  CLI::App* verb = app.add_subcommand(name, help);
  add(*verb, *options);
  return {verb, &options->common, [options, run] { return run(*options); }};
}

}  // namespace sightline::cli
