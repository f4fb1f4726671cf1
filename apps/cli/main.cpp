// The command line: what is typed becomes the option struct of a verb, what the verb throws becomes an exit code and
// one clear line. The only file that sees CLI11.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <functional>
#include <new>
#include <string>
#include <string_view>
#include <tuple>

#include "arguments.hpp"
#include "output.hpp"
#include "scene_argument.hpp"
#include "sightline/parallel/parallel.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

constexpr std::uint64_t most_frames = 1'000'000, most_threads = 1024, most_samples = 16;

/// An option whose text goes through read(text), which throws UsageError if it is not as `type` says.
template <class Read>
CLI::Option* add_text(CLI::App& app, const std::string& flags, const std::string& type, const std::string& help,
                      const std::string& shown_default, const Read& read) {
  const auto callback = [read](const CLI::results_t& results) {
    read(results.front());
    return true;
  };
  CLI::Option* option = app.add_option(flags, callback, help)->type_name(type);
  if (!shown_default.empty()) option->default_str(shown_default);
  return option;
}

template <class T>
void add_whole(CLI::App& app, const std::string& flag, const std::string& help, T& value, std::uint64_t low,
               std::uint64_t high) {
  add_text(app, flag, "N", help, fmt::to_string(value), [flag, &value, low, high](const std::string& text) {
    value = static_cast<T>(parse_whole(flag, text, low, high));
  });
}

void add_metres(CLI::App& app, const std::string& flag, const std::string& help, std::optional<double>& value,
                bool may_be_infinite = false) {
  add_text(app, flag, "METRES", help, "", [flag, &value, may_be_infinite](const std::string& text) {
    value = parse_positive(flag, text, may_be_infinite);
  });
}

void add_common(CLI::App& app, CommonOptions& options) {
  add_whole(app, "--threads", "threads to use; 0 for all", options.threads, 0, most_threads);
  add_whole(app, "--seed", "seed of generated scenes and paths", options.seed, 0, UINT64_MAX);
  app.add_option("--json", options.json, "write the result as JSON; - for standard output")->type_name("FILE");
  app.add_flag("--quiet", options.quiet, "no progress, warnings or tables");
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
    if (options.fov >= 180.0) throw UsageError(fmt::format("--fov: '{}' is not below 180", text));
  });
  add_metres(app, "--near", "near plane [from the size of the scene]", options.near);
  add_metres(app, "--far", "far plane, or inf [far enough for the scene]", options.far, true);
  add_metres(app, "--ortho", "orthographic view of this height", options.ortho);
}

void add_path(CLI::App& app, PathOptions& options) {
  app.add_option("--path", options.path, "viewpoints as text or JSON, or 'stress' [a generated walk]")
      ->type_name("FILE");
  add_whole(app, "--frames", "views on the path", options.frames, 1, most_frames);
}

void add_info(CLI::App& app, InfoOptions& options) {
  add_scene(app, options.scene);
  add_common(app, options.common);
  app.footer("Examples:\n  sightline info city.glb\n  sightline info generate:city:objects=20000 --json -");
}

void add_list(CLI::App& app, ListOptions& options) {
  app.add_flag("--markdown", options.markdown, "as tables of a README");
  add_common(app, options.common);
  app.footer("Examples:\n  sightline list\n  sightline list --json -\n  sightline list --markdown");
}

void add_generate(CLI::App& app, GenerateOptions& options) {
  app.add_option("KIND", options.kind, "a generator; see sightline list")->required();
  add_whole(app, "--objects", "about so many objects", options.objects, 1, most_objects);
  add_whole(app, "--triangles", "about so many triangles over all objects; 0 for what the kind finds natural",
            options.triangles, 0, most_triangles);
  app.add_option("-o,--output", options.output, "the file to write, .glb")->type_name("FILE")->required();
  add_common(app, options.common);
  app.footer("Examples:\n  sightline generate city --objects 20000 --seed 3 -o city.glb");
}

void add_walk(CLI::App& app, WalkOptions& options) {
  add_scene(app, options.scene);
  add_text(app, "--method", "NAME[:KEY=VALUE]...[,...]", "cullers to compare; see sightline list",
           options.methods.front(),
           [&options](const std::string& text) { options.methods = parse_names("--method", text); });
  add_path(app, options.path);
  add_camera(app, options.camera);
  add_whole(app, "--samples", "check N x N rays for each pixel", options.samples, 1, most_samples);
  app.add_flag("--ids", options.ids, "JSON: add the visible ids and the matrix of each frame, and the objects");
  app.add_flag_callback("--no-verify", [&options] { options.verify = false; }, "do not compare with the truth");
  app.add_option("--report", options.report, "write a page with the result to DIR/index.html")->type_name("DIR");
  add_common(app, options.common);
  app.footer(
      "Exit codes: 0 nothing visible was missed, 1 something was, 2 usage, 3 bad input, 4 internal, 130 "
      "interrupted.\n\n"
      "Examples:\n  sightline walk city.glb\n"
      "  sightline walk generate:city:objects=20000:seed=3 --method frustum_linear,occlusion_masked --frames 60\n"
      "  sightline walk ship.glb --path viewpoints.txt --json walk.json --ids --report report");
}

void add_render(CLI::App& app, RenderOptions& options) {
  add_scene(app, options.scene);
  app.add_option("--method", options.method, "a renderer, see sightline list; or oracle")
      ->type_name("NAME")
      ->capture_default_str();
  add_text(
      app, "--show", "depth|object|normal|shaded", "what the picture shows", "shaded",
      [&options](const std::string& text) {
        const std::array<std::pair<std::string_view, Show>, 4> kinds{
            {{"depth", Show::depth}, {"object", Show::object}, {"normal", Show::normal}, {"shaded", Show::shaded}}};
        const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.first == text; });
        if (kind == kinds.end())
          throw UsageError(fmt::format("--show: '{}' is not depth, object, normal or shaded", text));
        options.show = kind->second;
      });
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
  app.add_option("-o,--output", options.output, "the file to write, .png")->type_name("FILE")->required();
  add_common(app, options.common);
  app.footer(
      "Examples:\n  sightline render city.glb --eye 0,1.7,0 --look 1,0,0 -o view.png\n"
      "  sightline render city.glb --method oracle --show depth --path viewpoints.txt --frame 12 -o depth.png");
}

/// The command line as a person would type it again.
std::string command_line(int argc, char** argv) {
  std::string line = "sightline";
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    const bool plain = !word.empty() && word.find_first_of(" \t\n'\"\\$&|;<>()*?[]#~`!{}") == std::string_view::npos;
    line += plain ? fmt::format(" {}", word) : fmt::format(" '{}'", word);
  }
  return line;
}

struct Verb {
  CLI::App* app;
  const CommonOptions* common;
  std::function<int()> run;
};

template <class Options>
Verb add_verb(CLI::App& app, const std::string& name, const std::string& help, Options& options,
              void (*add)(CLI::App&, Options&), int (*run)(const Options&)) {
  CLI::App* verb = app.add_subcommand(name, help);
  add(*verb, options);
  return {verb, &options.common, [&options, run] { return run(options); }};
}

/// CLI11 names neither a verb that it does not know nor those that there are.
void check_verb(int argc, char** argv, const std::array<Verb, 5>& verbs) {
  if (argc >= 2 && argv[1][0] == '-') return;
  std::string names;
  for (const Verb& verb : verbs) {
    if (argc >= 2 && verb.app->get_name() == argv[1]) return;
    names += (names.empty() ? "" : ", ") + verb.app->get_name();
  }
  if (argc < 2) throw UsageError(fmt::format("a verb is needed: {}; or --help", names));
  throw UsageError(fmt::format("no verb is called '{}'; there are {}", argv[1], names));
}

int run(int argc, char** argv) {
  CLI::App app("What can be seen from here? Culls scenes, checks each answer against the truth, and draws.",
               "sightline");
  InfoOptions info;
  ListOptions list;
  GenerateOptions generate;
  WalkOptions walk;
  RenderOptions render;
  walk.command = command_line(argc, argv);
  const std::array<Verb, 5> verbs{
      add_verb(app, "info", "what a scene holds", info, add_info, run_info),
      add_verb(app, "list", "the algorithms and the generators", list, add_list, run_list),
      add_verb(app, "generate", "write a generated scene", generate, add_generate, run_generate),
      add_verb(app, "walk", "cull along a camera path and check against the truth", walk, add_walk, run_walk),
      add_verb(app, "render", "draw one view as a picture", render, add_render, run_render)};
  app.require_subcommand(1);
  app.set_version_flag("--version", "sightline " SIGHTLINE_VERSION);
  app.footer(
      "Examples:\n  sightline list\n  sightline walk generate:city --method occlusion_masked --frames 60\n"
      "\nsightline VERB --help tells more.");
  check_verb(argc, argv, verbs);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help_or_version) {
    app.exit(help_or_version);
    flush_stdout();
    return exit_ok;
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what());
  }
  const auto verb = std::find_if(verbs.begin(), verbs.end(), [](const Verb& v) { return v.app->parsed(); });
  const ThreadLimit limit(verb->common->threads);
  const int code = verb->run();
  flush_stdout();
  return code;
}

/// One line, whatever the message holds.
int complain(const char* prefix, std::string message, ExitCode code) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  fmt::print(stderr, "sightline: {}{}\n", prefix, message);
  return code;
}

}  // namespace
}  // namespace sightline::cli

int main(int argc, char** argv) {
  using namespace sightline::cli;
  try {
    return run(argc, argv);
  } catch (const UsageError& error) {
    return complain("", error.what(), exit_usage);
  } catch (const sightline::InputError& error) {
    return complain("", error.what(), exit_bad_input);
  } catch (const std::bad_alloc&) {
    return complain("", "out of memory", exit_internal);
  } catch (const std::exception& error) {
    return complain("internal error: ", error.what(), exit_internal);
  }
}
