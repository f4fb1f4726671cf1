// The command line as its definitions describe it: what manual page and shell completion are made of, so that they say
// what --help says.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace sightline::cli {

/// What a word of the command line may be.
struct ValueKind {
  enum Kind { none, file, folder, choice, other } kind = other;
  std::vector<std::string> choices;
};

struct InterfaceOption {
  std::string long_name, short_name;  // with dashes; both empty for a positional
  std::string type;                   // as --help shows it, empty for a flag
  std::string help;
  std::string shown_default;
  bool required = false;
  ValueKind value;

  [[nodiscard]] bool positional() const { return long_name.empty() && short_name.empty(); }
};

struct InterfaceVerb {
  std::string name, help, footer;
  std::vector<InterfaceOption> options;  // positionals first
};

struct Interface {
  std::string name, help, footer;
  std::vector<InterfaceVerb> verbs;  // those that --help shows
};

Interface interface_of(const CLI::App& app);

/// roff for man(1).
std::string manual_page(const Interface& interface);

/// A script for "bash", "zsh" or "fish". Throws UsageError for another shell.
std::string completion_script(const Interface& interface, const std::string& shell);

}  // namespace sightline::cli
