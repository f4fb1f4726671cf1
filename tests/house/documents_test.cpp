// What the documents say is what the code does: a page per algorithm, the README's table and its example.
#include <gtest/gtest.h>

#include <array>
#include <cctype>
#include <cstdio>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "house/files.hpp"
#include "sightline/registry.hpp"
#ifdef SIGHTLINE_HAS_GL
#include "gl/registry.hpp"
#endif

namespace sightline::house {
namespace {

/// The text between two markers, without the line ends next to them; fails the test if a marker is missing.
std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t first = text.find(begin);
  if (first == std::string::npos) {
    ADD_FAILURE() << "no marker " << begin;
    return "";
  }
  const std::size_t start = text.find('\n', first) + 1;
  const std::size_t last = text.find(end, start);
  if (last == std::string::npos) {
    ADD_FAILURE() << "no marker " << end;
    return "";
  }
  return text.substr(start, last - start);
}

/// What the tool prints to stdout, and its exit status.
std::pair<std::string, int> run_tool(const std::string& arguments) {
  const std::string command = std::string("'") + SIGHTLINE_TOOL + "' " + arguments;
  FILE* const pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return {"", -1};
  std::string text;
  std::array<char, 4096> buffer{};
  for (std::size_t n = 0; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) text.append(buffer.data(), n);
  return {text, pclose(pipe)};
}

/// The rows of all tables that the tool joins.
std::vector<Algorithm> all_rows() {
  std::vector<Algorithm> rows(algorithms().begin(), algorithms().end());
#ifdef SIGHTLINE_HAS_GL
  for (const gl::GlAlgorithm& algorithm : gl::algorithms()) rows.push_back(algorithm.row);
#endif
  return rows;
}

TEST(House, EveryAlgorithmHasAPage) {
  ASSERT_FALSE(algorithms().empty());
  for (const Algorithm& row : all_rows()) {
    const std::filesystem::path file = root() / "docs/algorithms" / (std::string(row.name) + ".md");
    const std::string page = read_text(file);
    ASSERT_FALSE(page.empty()) << "no page " << file;
    EXPECT_EQ(page.rfind("# " + std::string(row.name) + "\n", 0), 0u) << file << " does not open with the name";
    for (const char* section : {"## Idea", "## Promise", "## Parameters", "## Source"})
      EXPECT_NE(page.find(section), std::string::npos) << file << " has no section " << section;
    const std::string promise = between(page, "## Promise", "## ");
    EXPECT_NE(promise.find("`" + std::string(to_string(row.promise)) + "`"), std::string::npos)
        << file << " does not state the promise " << to_string(row.promise);
  }
}

TEST(House, EveryPageHasAnAlgorithm) {
  std::set<std::string> names;
  for (const Algorithm& row : all_rows())
    EXPECT_TRUE(names.insert(std::string(row.name)).second) << row.name << " is in the registry twice";
  for (const auto& entry : std::filesystem::directory_iterator(root() / "docs/algorithms")) {
    if (entry.path().extension() != ".md") continue;
    EXPECT_EQ(names.count(entry.path().stem().string()), 1u) << entry.path() << " describes no row of the registry";
  }
}

TEST(House, ReadmeTableIsTheRegistry) {
  const auto [table, status] = run_tool("list --markdown");
  ASSERT_EQ(status, 0) << SIGHTLINE_TOOL << " list --markdown failed";
  for (const Algorithm& row : all_rows()) EXPECT_NE(table.find(std::string(row.name)), std::string::npos) << row.name;
  EXPECT_EQ(between(read_text(root() / "README.md"), "<!-- algorithms: ", "<!-- /algorithms -->"), table)
      << "run ./dev docs";
}

TEST(House, ReadmeExamplesAreTheCompiledOnes) {
  for (const char* file : {"examples/what_is_seen.cpp", "examples/occlusion_buffer.cpp"}) {
    const std::string source = read_text(root() / file);
    ASSERT_FALSE(source.empty());
    std::string example;
    for (const std::string& line : lines_of(between(source, "// [readme]", "  // [/readme]")))
      example += (line.rfind("  ", 0) == 0 ? line.substr(2) : line) + "\n";
    EXPECT_GE(lines_of(example).size(), 5u);
    EXPECT_NE(read_text(root() / "README.md").find("```cpp\n" + example + "```\n"), std::string::npos)
        << "README.md does not show the example of " << file << " verbatim";
  }
}

TEST(House, ReadmeNamesTheCommands) {
  const std::string readme = read_text(root() / "README.md");
  for (const char* command : {"./dev demo", "./dev test"})
    EXPECT_NE(readme.find(command), std::string::npos) << command;
}

}  // namespace
}  // namespace sightline::house
