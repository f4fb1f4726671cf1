// The command line: what is typed becomes the option struct of a verb, what the verb throws becomes an exit code and
// one clear line.
#include <fmt/format.h>

#include <algorithm>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "command.hpp"
#include "interrupt.hpp"
#include "methods.hpp"
#include "output.hpp"
#include "scene_argument.hpp"
#include "sightline/parallel/parallel.hpp"

namespace sightline::cli {

// The table of verbs, in the order in which --help shows them: a new verb is a *_command.cpp and two lines here.
Verb info_command(CLI::App& app);
Verb list_command(CLI::App& app);
Verb generate_command(CLI::App& app);
Verb walk_command(CLI::App& app);
Verb compare_command(CLI::App& app);
Verb explain_command(CLI::App& app);
Verb view_command(CLI::App& app);
Verb render_command(CLI::App& app);
Verb raster_report_command(CLI::App& app);
Verb occluders_command(CLI::App& app);
Verb bounds_command(CLI::App& app);
Verb sigma_command(CLI::App& app);
Verb structures_command(CLI::App& app);
Verb persistence_command(CLI::App& app);
Verb queries_command(CLI::App& app);
Verb visible_faces_command(CLI::App& app);
Verb sight_lines_command(CLI::App& app);
Verb maze_command(CLI::App& app);
Verb completion_command(CLI::App& app);
Verb manual_command(CLI::App& app);
Verb bsp_command(CLI::App& app);
Verb boolean_command(CLI::App& app);
Verb detail_command(CLI::App& app);
Verb faces_command(CLI::App& app);

namespace {

constexpr Verb (*commands[])(CLI::App&) = {
    info_command,          list_command,        generate_command,   walk_command,          compare_command,
    explain_command,       view_command,        render_command,     raster_report_command, occluders_command,
    bounds_command,        sigma_command,       structures_command, persistence_command,   queries_command,
    visible_faces_command, sight_lines_command, maze_command,       completion_command,    manual_command,
    bsp_command,           boolean_command,     detail_command,     faces_command,
};

/// CLI11 names neither a verb that it does not know nor those that there are.
void check_verb(int argc, char** argv, const std::vector<Verb>& verbs) {
  for (const std::string_view known : {"-h", "--help", "--version"})
    if (argc >= 2 && argv[1] == known) return;
  std::string names;
  for (const Verb& verb : verbs) {
    if (argc >= 2 && verb.app->get_name() == argv[1]) return;
    if (verb.app->get_group().empty()) continue;  // hidden
    names += (names.empty() ? "" : ", ") + verb.app->get_name();
  }
  if (argc < 2) throw UsageError(fmt::format("a verb is needed: {}; or --help", names));
  throw UsageError(fmt::format("no verb is called '{}'; there are {}", argv[1], names));
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

int run(int argc, char** argv) {
  CLI::App app("What can be seen from here? Culls scenes, checks each answer against the truth, and draws.",
               "sightline");
  std::vector<Verb> verbs;
  for (const auto command : commands) verbs.push_back(command(app));
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
  verb->common->stdout_taken = check_outputs(*verb->app);
  verb->common->command = command_line(argc, argv);
  set_progress(verb->common->progress);
  const ThreadLimit limit(verb->common->threads);
  const int code = verb->run();
  flush_stdout();
  return code;
}

/// One line, whatever the message holds.
int complain(const char* prefix, std::string message, ExitCode code) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  tell(fmt::format("sightline: {}{}\n", prefix, message));
  return code;
}

}  // namespace
}  // namespace sightline::cli

int main(int argc, char** argv) {
  using namespace sightline::cli;
  occupy_closed_streams();
  leave_nothing_unfinished();
  try {
    return run(argc, argv);
  } catch (const UsageError& error) {
    return complain("", error.what(), exit_usage);
  } catch (const sightline::InputError& error) {
    return complain("", error.what(), exit_bad_input);
  } catch (const MethodUnavailable& error) {
    return complain("", error.what(), exit_internal);
  } catch (const std::bad_alloc&) {
    return complain("", "out of memory", exit_internal);
  } catch (const std::system_error& error) {
    if (std::ferror(stdout) == 0) return complain("internal error: ", error.what(), exit_internal);
    return complain("standard output: ", error.what(), exit_bad_input);  // what fmt::print throws
  } catch (const std::exception& error) {
    return complain("internal error: ", error.what(), exit_internal);
  }
}
