// The manual page: roff, in the order of man-pages(7).
#include <fmt/format.h>

#include <iterator>

#include "interface.hpp"
#include "options.hpp"

namespace sightline::cli {
namespace {

/// Text of which roff takes nothing for a command.
std::string plain(std::string_view text) {
  std::string result;
  for (const char c : text) {
    const bool line_start = result.empty() || result.back() == '\n';
    if (line_start && (c == '.' || c == '\'')) result += "\\&";
    if (c == '\\')
      result += "\\e";
    else if (c == '-')
      result += "\\-";
    else
      result += c;
  }
  return result;
}

std::string upper(std::string_view text) {
  std::string result;
  for (const char c : text) result += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return result;
}

/// ".TP", the option as it is typed, and what it does.
void add_option(std::string& page, const InterfaceOption& option) {
  page += ".TP\n";
  if (option.positional()) {
    page += fmt::format("\\fI{}\\fR\n", plain(option.type));
  } else {
    std::string names;
    for (const std::string& name : {option.short_name, option.long_name})
      if (!name.empty()) names += (names.empty() ? "\\fB" : ", \\fB") + plain(name) + "\\fR";
    page += names + (option.type.empty() ? "" : fmt::format(" \\fI{}\\fR", plain(option.type))) + "\n";
  }
  std::string help = plain(option.help);
  if (option.required) help += " (required)";
  if (!option.shown_default.empty()) help += fmt::format(" (default {})", plain(option.shown_default));
  page += help + "\n";
}

/// The footer of --help: lines as they are.
void add_verbatim(std::string& page, std::string_view text) {
  if (text.empty()) return;
  page += ".PP\n.nf\n" + plain(text) + "\n.fi\n";
}

std::string synopsis(const Interface& interface, const InterfaceVerb& verb) {
  std::string line = fmt::format(".B {} {}\n", interface.name, verb.name);
  for (const InterfaceOption& option : verb.options)
    if (option.positional()) line += fmt::format(".I {}\n", plain(option.type));
  for (const InterfaceOption& option : verb.options)
    if (option.required && !option.positional())
      line += fmt::format(".B {}\n.I {}\n", plain(option.short_name.empty() ? option.long_name : option.short_name),
                          plain(option.type));
  return line + ".RI [ options ]\n.br\n";
}

}  // namespace

std::string manual_page(const Interface& interface) {
  std::string page = fmt::format(".TH {} 1 \"\" \"{} {}\" \"User Commands\"\n", upper(interface.name), interface.name,
                                 SIGHTLINE_VERSION);
  page += fmt::format(".SH NAME\n{} \\- what can be seen from here?\n.SH SYNOPSIS\n", interface.name);
  for (const InterfaceVerb& verb : interface.verbs) page += synopsis(interface, verb);
  page += fmt::format(".SH DESCRIPTION\n{}\n", plain(interface.help));
  for (const InterfaceVerb& verb : interface.verbs) {
    page += fmt::format(".SH {}\n{}: {}.\n", upper(verb.name), plain(verb.name), plain(verb.help));
    for (const InterfaceOption& option : verb.options) add_option(page, option);
    add_verbatim(page, verb.footer);
  }
  page += ".SH EXIT STATUS\n";
  for (const auto& [code, meaning] :
       {std::pair{exit_ok, "all is well"}, std::pair{exit_missed, "something visible was missed"},
        std::pair{exit_usage, "the command line makes no sense"}, std::pair{exit_bad_input, "bad input or output"},
        std::pair{exit_internal, "internal error"}, std::pair{exit_interrupted, "interrupted; what was done is kept"}})
    page += fmt::format(".TP\n{}\n{}\n", static_cast<int>(code), meaning);
  page += ".SH ENVIRONMENT\n.TP\nNO_COLOR\nif set and not empty: no colours, also on a terminal\n";
  add_verbatim(page += ".SH EXAMPLES\n", interface.footer);
  return page;
}

}  // namespace sightline::cli
