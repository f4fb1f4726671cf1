// What CLI11 knows of the command line, as plain values; and the verbs that print it for shells and man.
#include <fmt/format.h>

#include <algorithm>

#include "command.hpp"
#include "interface.hpp"
#include "methods.hpp"
#include "output.hpp"
#include "sightline/registry.hpp"
#include "sightline/scene/generate/generate.hpp"

namespace sightline::cli {
namespace {

std::vector<std::string> parts_of(const std::string& text, char separator) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

/// What --method of a verb takes: only walk and view make cullers that run through OpenGL.
std::vector<std::string> method_names(const std::string& verb) {
  const Family family = verb == "render" ? Family::renderer : verb == "faces" ? Family::face_culler : Family::culler;
  const bool also_gl = verb == "walk" || verb == "view";
  std::vector<std::string> names;
  for (const Algorithm& row : also_gl ? std::span<const Algorithm>(all_algorithms()) : algorithms())
    if (row.family == family) names.emplace_back(row.name);
  if (verb == "render") names.emplace_back("oracle");
  return names;
}

ValueKind kind_of(const std::string& verb, const InterfaceOption& option) {
  if (option.type.empty() && !option.positional()) return {ValueKind::none, {}};
  if (option.long_name == "--method") return {ValueKind::choice, method_names(verb)};
  if (option.type == "FILE" || option.type == "SCENE") return {ValueKind::file, {}};
  if (option.type == "DIR") return {ValueKind::folder, {}};
  if (option.type == "KIND") {
    ValueKind kinds{ValueKind::choice, {}};
    for (const Generator& row : generators()) kinds.choices.emplace_back(row.name);
    return kinds;
  }
  if (option.type.find('|') != std::string::npos) return {ValueKind::choice, parts_of(option.type, '|')};
  return {};
}

InterfaceOption option_of(const std::string& verb, const CLI::Option& from) {
  InterfaceOption option;
  if (!from.get_lnames().empty()) option.long_name = "--" + from.get_lnames().front();
  if (!from.get_snames().empty()) option.short_name = "-" + from.get_snames().front();
  const bool flag = from.get_items_expected_max() == 0;
  const bool positional = option.positional();
  const std::string type = from.get_type_name();
  if (positional)
    option.type = type.find('|') != std::string::npos ? type : from.get_name(true);
  else if (!flag)
    option.type = type;
  option.help = from.get_description();
  option.shown_default = from.get_default_str();
  option.required = from.get_required();
  option.value = kind_of(verb, option);
  return option;
}

struct ShellOptions {
  CommonOptions common;
  std::string shell;
};

int print_text(const std::string& text) {
  OutputFile out("-");
  out.write(text);
  out.commit();
  return exit_ok;
}

}  // namespace

Interface interface_of(const CLI::App& app) {
  Interface interface{app.get_name(), app.get_description(), app.get_footer(), {}};
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App* a) { return !a->get_group().empty(); })) {
    InterfaceVerb entry{verb->get_name(), verb->get_description(), verb->get_footer(), {}};
    for (const CLI::Option* option : verb->get_options()) entry.options.push_back(option_of(entry.name, *option));
    std::stable_partition(entry.options.begin(), entry.options.end(),
                          [](const InterfaceOption& option) { return option.positional(); });
    interface.verbs.push_back(std::move(entry));
  }
  return interface;
}

Verb completion_command(CLI::App& app) {
  const auto options = std::make_shared<ShellOptions>();
  CLI::App* verb = app.add_subcommand("completion", "a script that completes command lines in your shell");
  verb->add_option("SHELL", options->shell, "bash, zsh or fish")->type_name("bash|zsh|fish")->required();
  add_common(*verb, options->common);
  verb->footer(
      "Examples:\n  source <(sightline completion bash)\n"
      "  sightline completion zsh > ~/.zfunc/_sightline\n"
      "  sightline completion fish > ~/.config/fish/completions/sightline.fish");
  return {verb, &options->common,
          [&app, options] { return print_text(completion_script(interface_of(app), options->shell)); }};
}

Verb manual_command(CLI::App& app) {
  const auto options = std::make_shared<CommonOptions>();
  CLI::App* verb = app.add_subcommand("manual", "the manual page, as roff")->group("");
  add_common(*verb, *options);
  return {verb, options.get(), [&app, options] { return print_text(manual_page(interface_of(app))); }};
}

}  // namespace sightline::cli
