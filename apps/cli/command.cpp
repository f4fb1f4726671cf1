#include "command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <tuple>

#include "sightline/scene/scene.hpp"

namespace sightline::cli {

CLI::Option* add_text(CLI::App& app, const std::string& flags, const std::string& type, const std::string& help,
                      const std::string& shown_default, const std::function<void(const std::string&)>& read) {
  const auto callback = [read](const CLI::results_t& results) {
    read(results.front());
    return true;
  };
  CLI::Option* option = app.add_option(flags, callback, help)->type_name(type);
  if (!shown_default.empty()) option->default_str(shown_default);
  return option;
}

CLI::Option* add_metres(CLI::App& app, const std::string& flag, const std::string& help, std::optional<double>& value,
                        bool may_be_infinite) {
  return add_text(app, flag, "METRES", help, "", [flag, &value, may_be_infinite](const std::string& text) {
    value = parse_positive(flag, text, may_be_infinite);
    if (*value < smallest_distance || (*value > largest_distance && !may_be_infinite))
      throw UsageError(fmt::format("{}: '{}' is not between 1e-9 and 1e15 m", flag, text));
  });
}

CLI::Option* add_output(CLI::App& app, const std::string& flags, const std::string& help, std::string& file,
                        const std::string& ending) {
  const std::string name = flags.substr(flags.find("--"));
  return add_text(app, flags, "FILE", help, "", [name, ending, &file](const std::string& text) {
    if (text.empty()) throw UsageError(name + ": the name of the file is empty");
    std::error_code ignored;
    const bool stream = text == "-" || std::filesystem::is_character_file(text, ignored);
    if (!stream && !text.ends_with(ending)) throw UsageError(fmt::format("{}: '{}' is no {} file", name, text, ending));
    file = text;
  });
}

bool check_outputs(const CLI::App& verb) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  const auto is_file = [](const CLI::Option* option) { return option->get_type_name() == "FILE"; };
  const auto place = [&](const CLI::Option* option) {
    return fs::weakly_canonical(option->results().front(), ignored);
  };
  const auto given = verb.get_options([](const CLI::Option* option) { return option->count() > 0; });
  for (const CLI::Option* output : given) {
    const fs::path file = place(output);
    if (!is_file(output) || file.empty()) continue;
    const bool there = fs::is_regular_file(file, ignored);
    if (!there && fs::exists(file, ignored)) continue;  // devices and pipes take any number of writers
    for (const CLI::Option* other : given)
      if (output != other && (there || is_file(other)) && file == place(other))
        throw UsageError(fmt::format("{} and {} are the same file, '{}'", output->get_name(), other->get_name(),
                                     output->results().front()));
  }
  return std::any_of(given.begin(), given.end(),
                     [&](const CLI::Option* option) { return is_file(option) && option->results().front() == "-"; });
}

void add_common(CLI::App& app, CommonOptions& options) {
  add_whole(app, "--threads", "threads to use; 0 for all", options.threads, 0, most_threads);
  add_whole(app, "--seed", "seed of generated scenes and paths", options.seed, 0, UINT64_MAX);
  add_output(app, "--json", "write the result as JSON; - for standard output", options.json);
  app.add_flag("--quiet", options.quiet, "no progress bar, warnings or tables");
  app.add_flag("--strict", options.strict, "what a scene file has and is not used is an error, not a warning");
  add_text(app, "--progress", "auto|json|none", "a bar on a terminal, JSON lines on standard error, or nothing", "auto",
           [&options](const std::string& text) { options.progress = parse_progress("--progress", text); });
}

void add_scene(CLI::App& app, std::string& scene) {
  app.add_option("SCENE", scene, "a scene file, or generate:KIND[:objects=N][:triangles=N][:seed=N]")->required();
}

void add_camera(CLI::App& app, CameraOptions& options) {
  add_text(app, "--size", "WxH", "pixels of the view", "1280x720", [&options](const std::string& text) {
    std::tie(options.width, options.height) = parse_size("--size", text);
  });
  add_text(app, "--fov", "DEGREES", "vertical angle of the view, below 180", "60", [&options](const std::string& text) {
    options.fov = parse_positive("--fov", text);
    if (!(options.fov > 0.006 && options.fov < 179.994))
      throw UsageError(fmt::format("--fov: '{}' is not between 0.006 and 179.994", text));
  });
  add_metres(app, "--near", "near plane [from the size of the scene]", options.near);
  add_metres(app, "--far", "far plane, or inf [far enough for the scene]", options.far, true);
  add_metres(app, "--ortho", "orthographic view of this height", options.ortho);
}

void add_path(CLI::App& app, PathOptions& options) {
  app.add_option("--path", options.path,
                 "viewpoints as text or JSON; stress; camera or camera:NAME of the scene [a generated walk]")
      ->type_name("FILE");
  add_whole(app, "--frames", "views on the path", options.frames, 1, most_frames);
}

void add_view(CLI::App& app, ViewOptions& options) {
  CLI::Option* eye = add_text(app, "--eye", "X,Y,Z", "where the eye is, metres", "",
                              [&options](const std::string& text) { options.eye = parse_vector("--eye", text); });
  add_text(app, "--look", "DX,DY,DZ", "where it looks", "0,0,-1", [&options](const std::string& text) {
    options.look = parse_vector("--look", text);
    if (options.look == glm::dvec3(0.0)) throw UsageError("--look: the direction has no length");
  })->needs(eye);
  add_path(app, options.path);
  app.get_option("--path")->excludes(eye);
  add_whole(app, "--frame", "which view of the path, from 0", options.frame, 0, most_frames);
  app.get_option("--frame")->excludes(eye);
  add_camera(app, options.camera);
}

}  // namespace sightline::cli
