// Completion of command lines in bash, zsh and fish, made from the definitions of the options.
#include <fmt/format.h>

#include <iterator>

#include "interface.hpp"
#include "options.hpp"

namespace sightline::cli {
namespace {

std::string join(const std::vector<std::string>& words, std::string_view between) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : std::string(between)) + word;
  return text;
}

std::vector<std::string> names_of(const InterfaceOption& option) {
  std::vector<std::string> names;
  for (const std::string& name : {option.short_name, option.long_name})
    if (!name.empty()) names.push_back(name);
  return names;
}

std::vector<std::string> verb_names(const Interface& interface) {
  std::vector<std::string> names;
  for (const InterfaceVerb& verb : interface.verbs) names.push_back(verb.name);
  return names;
}

std::string replaced(std::string text, std::string_view what, std::string_view by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

// bash

std::string bash_value(const ValueKind& value) {
  switch (value.kind) {
    case ValueKind::file:
      return "compgen -f -- \"$word\"";
    case ValueKind::folder:
      return "compgen -d -- \"$word\"";
    case ValueKind::choice:
      return fmt::format("compgen -W '{}' -- \"$word\"", join(value.choices, " "));
    default:
      return "true";
  }
}

std::string bash_verb(const InterfaceVerb& verb) {
  std::string values, positional = "true";
  std::vector<std::string> names;
  for (const InterfaceOption& option : verb.options) {
    if (option.positional()) {
      positional = bash_value(option.value);
      continue;
    }
    for (const std::string& name : names_of(option)) names.push_back(name);
    if (option.value.kind != ValueKind::none)
      values += fmt::format("        {}) {}; return ;;\n", join(names_of(option), " | "), bash_value(option.value));
  }
  return fmt::format(
      "    {})\n      case $before in\n{}      esac\n      if [[ $word == -* ]]; then compgen -W '{}' -- \"$word\"; "
      "else {}; fi ;;\n",
      verb.name, values, join(names, " "), positional);
}

std::string bash_script(const Interface& interface) {
  std::string verbs;
  for (const InterfaceVerb& verb : interface.verbs) verbs += bash_verb(verb);
  return fmt::format(
      "# bash completion of {0}; written by: {0} completion bash\n"
      "_{0}_words() {{\n  local word=$1 before=$2 verb=$3\n  case $verb in\n"
      "    '') compgen -W '{1} --help --version' -- \"$word\" ;;\n{2}  esac\n}}\n"
      "_{0}() {{\n  local verb=\n  if ((COMP_CWORD > 1)); then verb=${{COMP_WORDS[1]}}; fi\n"
      "  mapfile -t COMPREPLY < <(_{0}_words \"${{COMP_WORDS[COMP_CWORD]}}\" \"${{COMP_WORDS[COMP_CWORD - 1]}}\" "
      "\"$verb\")\n}}\ncomplete -o filenames -F _{0} {0}\n",
      interface.name, join(verb_names(interface), " "), verbs);
}

// zsh

/// Fit to stand in '...' inside of brackets or after a colon of an _arguments specification.
std::string zsh_text(std::string text) {
  for (const std::string_view special : {"\\", "[", "]", ":"})
    text = replaced(text, special, "\\" + std::string(special));
  return replaced(text, "'", "'\\''");
}

std::string zsh_value(const InterfaceOption& option) {
  const std::string label = zsh_text(option.type);
  switch (option.value.kind) {
    case ValueKind::none:
      return "";
    case ValueKind::file:
      return fmt::format(":{}:_files", label);
    case ValueKind::folder:
      return fmt::format(":{}:_files -/", label);
    case ValueKind::choice:
      return fmt::format(":{}:({})", label, join(option.value.choices, " "));
    default:
      return fmt::format(":{}: ", label);
  }
}

std::string zsh_verb(const InterfaceVerb& verb) {
  std::string text = fmt::format("    {})\n      _arguments -s", verb.name);
  int place = 0;
  for (const InterfaceOption& option : verb.options) {
    if (option.positional()) text += fmt::format(" \\\n        '{}{}'", ++place, zsh_value(option));
    for (const std::string& name : names_of(option))
      text += fmt::format(" \\\n        '{}[{}]{}'", name, zsh_text(option.help), zsh_value(option));
  }
  return text + " ;;\n";
}

std::string zsh_script(const Interface& interface) {
  std::string list, verbs;
  for (const InterfaceVerb& verb : interface.verbs) {
    list += fmt::format(" '{}:{}'", verb.name, zsh_text(verb.help));
    verbs += zsh_verb(verb);
  }
  return fmt::format(
      "#compdef {0}\n# zsh completion of {0}; written by: {0} completion zsh\n_{0}() {{\n"
      "  if ((CURRENT == 2)); then\n    local -a verbs=({1})\n    _describe verb verbs\n"
      "    _arguments '--help[help]' '--version[version]'\n    return\n  fi\n"
      "  shift words\n  ((CURRENT--))\n  case $words[1] in\n{2}  esac\n}}\n"
      "if [[ $funcstack[1] == _{0} ]]; then _{0} \"$@\"; else compdef _{0} {0}; fi\n",
      interface.name, list, verbs);
}

// fish

std::string fish_text(const std::string& text) {
  return "'" + replaced(replaced(text, "\\", "\\\\"), "'", "\\'") + "'";
}

std::string fish_value(const ValueKind& value) {
  switch (value.kind) {
    case ValueKind::none:
      return "";
    case ValueKind::file:
      return " -r -F";
    case ValueKind::folder:
      return " -x -a '(__fish_complete_directories)'";
    case ValueKind::choice:
      return fmt::format(" -x -a '{}'", join(value.choices, " "));
    default:
      return " -x";
  }
}

std::string fish_option(const std::string& command, const InterfaceVerb& verb, const InterfaceOption& option) {
  std::string line = fmt::format("complete -c {} -n '__fish_seen_subcommand_from {}'", command, verb.name);
  if (option.positional()) {
    if (option.value.kind == ValueKind::choice)
      return line + fmt::format(" -a '{}'\n", join(option.value.choices, " "));
    return option.value.kind == ValueKind::file ? line + " -F\n" : "";
  }
  if (!option.short_name.empty()) line += " -s " + option.short_name.substr(1);
  if (!option.long_name.empty()) line += " -l " + option.long_name.substr(2);
  return line + fish_value(option.value) + " -d " + fish_text(option.help) + "\n";
}

std::string fish_script(const Interface& interface) {
  std::string text =
      fmt::format("# fish completion of {0}; written by: {0} completion fish\ncomplete -c {0} -f\n", interface.name);
  for (const InterfaceVerb& verb : interface.verbs) {
    text += fmt::format("complete -c {} -n __fish_use_subcommand -a {} -d {}\n", interface.name, verb.name,
                        fish_text(verb.help));
    for (const InterfaceOption& option : verb.options) text += fish_option(interface.name, verb, option);
  }
  return text;
}

}  // namespace

std::string completion_script(const Interface& interface, const std::string& shell) {
  if (shell == "bash") return bash_script(interface);
  if (shell == "zsh") return zsh_script(interface);
  if (shell == "fish") return fish_script(interface);
  throw UsageError(fmt::format("no completion for '{}'; there is bash, zsh and fish", shell));
}

}  // namespace sightline::cli
