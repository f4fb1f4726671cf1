// sightline list: the registry and the generators, as text, JSON, or the tables of the README.
#include <fmt/format.h>

#include <algorithm>

#include "json_output.hpp"
#include "methods.hpp"
#include "sightline/scene/generate/generate.hpp"
#include "verbs.hpp"

namespace sightline::cli {
namespace {

Json list_json() {
  Json json{{"schema", "sightline.list/1"}, {"algorithms", Json::array()}, {"generators", Json::array()}};
  for (const Algorithm& row : all_algorithms())
    json["algorithms"].push_back({{"name", row.name},
                                  {"family", to_string(row.family)},
                                  {"promise", to_string(row.promise)},
                                  {"paper", row.paper},
                                  {"checklist", row.checklist},
                                  {"summary", row.summary}});
  for (const Generator& row : generators())
    json["generators"].push_back({{"name", row.name}, {"summary", row.summary}});
  return json;
}

void print_markdown() {
  fmt::print("| name | family | promise | paper | checklist | summary |\n|---|---|---|---|---|---|\n");
  for (const Algorithm& row : all_algorithms())
    fmt::print("| [`{0}`](docs/algorithms/{0}.md) | {1} | {2} | {3} | {4} | {5} |\n", row.name, to_string(row.family),
               to_string(row.promise), row.paper, row.checklist, row.summary);
  fmt::print("\n| generator | summary |\n|---|---|\n");
  for (const Generator& row : generators()) fmt::print("| `{}` | {} |\n", row.name, row.summary);
}

void print_text() {
  std::size_t name = 4, paper = 5, checklist = 9;
  for (const Algorithm& row : all_algorithms()) {
    name = std::max(name, row.name.size());
    paper = std::max(paper, row.paper.size());
    checklist = std::max(checklist, row.checklist.size());
  }
  for (const Generator& row : generators()) name = std::max(name, row.name.size());
  const auto line = [&](auto... cells) { fmt::print("{:<{}}  {:<11}  {:<23}  {:<{}}  {:<{}}  {}\n", cells...); };
  line("name", name, "family", "promise", "paper", paper, "checklist", checklist, "summary");
  for (const Algorithm& row : all_algorithms())
    line(row.name, name, to_string(row.family), to_string(row.promise), row.paper, paper, row.checklist, checklist,
         row.summary);
  fmt::print("\n{:<{}}  summary\n", "generator", name);
  for (const Generator& row : generators()) fmt::print("{:<{}}  {}\n", row.name, name, row.summary);
}

}  // namespace

int run_list(const ListOptions& options) {
  JsonOutput output(options.common);
  if (options.markdown)
    print_markdown();
  else if (!options.common.stdout_taken)
    print_text();
  output.write(list_json());
  return exit_ok;
}

}  // namespace sightline::cli
