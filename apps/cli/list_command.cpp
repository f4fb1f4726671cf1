// The options of sightline list.
#include "command.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

void add_list(CLI::App& app, ListOptions& options) {
  CLI::Option* markdown = app.add_flag("--markdown", options.markdown, "as tables of a README");
  add_common(app, options.common);
  app.get_option("--json")->excludes(markdown);
  app.footer("Examples:\n  sightline list\n  sightline list --json -\n  sightline list --markdown");
}

}  // namespace

Verb list_command(CLI::App& app) {
  return add_verb(app, "list", "the algorithms and the generators", add_list, run_list);
}

}  // namespace sightline::cli
