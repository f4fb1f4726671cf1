// The layout of the house holds: includes point one way, files stay short, names carry meaning.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <regex>
#include <string>
#include <vector>

#include "house/files.hpp"

namespace sightline::house {

namespace {

// From the ground up. A file includes its own room and the floors below; rooms of one floor do not know each other.
const std::vector<std::vector<std::string>> floors{
    {"geometry", "parallel"},
    {"index"},
    {"scene"},
    {"core"},
    {"raster", "oracle", "gl", "mpi"},
    {"effects", "surface", "cull", "lines", "bake"},
    {"registry"},
    {"apps"},
};

std::optional<std::size_t> floor_of(const std::string& room) {
  for (std::size_t i = 0; i < floors.size(); ++i)
    if (std::find(floors[i].begin(), floors[i].end(), room) != floors[i].end()) return i;
  return std::nullopt;
}

/// The room of a path relative to src/: "sightline/cull/x.hpp" is in cull, "sightline/registry.hpp" in registry.
std::string room_of_include(const std::string& path) {
  const std::string prefix = "sightline/";
  if (path.rfind(prefix, 0) != 0) return path.substr(0, path.find('/'));
  const std::string inner = path.substr(prefix.size());
  const std::size_t slash = inner.find('/');
  return slash == std::string::npos ? inner.substr(0, inner.find('.')) : inner.substr(0, slash);
}

std::string room_of_file(const std::string& path) {
  return path.rfind("apps/", 0) == 0 ? "apps" : room_of_include(path.substr(std::string("src/").size()));
}

/// The paths of #include "..." lines that name a file of the library.
std::vector<std::string> library_includes(const std::string& text) {
  static const std::regex pattern(R"re(^\s*#\s*include\s*[<"]((?:sightline|gl|mpi|apps)/[^>"]+)[>"])re");
  std::vector<std::string> includes;
  for (const std::string& line : lines_of(text)) {
    std::smatch match;
    if (std::regex_search(line, match, pattern)) includes.push_back(match[1]);
  }
  return includes;
}

/// What is wrong with an include of `included` in `room`, or an empty string.
std::string complaint(const std::string& room, const std::string& included) {
  const std::string other = room_of_include(included);
  const auto floor = floor_of(room);
  const auto below = floor_of(other);
  if (!floor) return "unknown room " + room;
  if (!below) return "unknown room " + other;
  if (room == other || *below < *floor) return "";
  return room + " must not include " + included;
}

TEST(House, IncludesPointOneWay) {
  const std::vector<SourceFile> files = cpp_files({"src", "apps"});
  ASSERT_GT(files.size(), 20u);
  std::size_t seen = 0;
  for (const SourceFile& file : files)
    for (const std::string& included : library_includes(file.text)) {
      ++seen;
      EXPECT_EQ(complaint(room_of_file(file.path), included), "") << file.path;
    }
  EXPECT_GT(seen, 20u) << "the pattern finds no includes any more";
}

TEST(House, IncludeCheckSeesWhatIsForbidden) {
  EXPECT_EQ(complaint("cull", "sightline/geometry/aabb.hpp"), "");
  EXPECT_EQ(complaint("cull", "sightline/cull/none.hpp"), "");
  EXPECT_NE(complaint("cull", "sightline/surface/zbuffer.hpp"), "");
  EXPECT_NE(complaint("surface", "sightline/cull/none.hpp"), "");
  EXPECT_NE(complaint("geometry", "sightline/scene/view.hpp"), "");
  EXPECT_NE(complaint("core", "sightline/registry.hpp"), "");
  EXPECT_NE(complaint("raster", "sightline/oracle/oracle.hpp"), "");
  EXPECT_NE(complaint("core", "gl/context.hpp"), "");
  EXPECT_NE(complaint("core", "sightline/attic/junk.hpp"), "");
  EXPECT_EQ(library_includes("#include \"sightline/core/frame.hpp\"\n#include <vector>\n").size(), 1u);
}

/// Lines at the start of a file that are comments.
std::string first_comment(const std::string& text) {
  std::string comment;
  for (const std::string& line : lines_of(text)) {
    if (line.rfind("//", 0) != 0) break;
    comment += line + "\n";
  }
  return comment;
}

TEST(House, LongFilesGiveAReason) {
  for (const SourceFile& file : cpp_files({"src", "apps", "tests", "bench", "examples"})) {
    const std::size_t lines = lines_of(file.text).size();
    if (lines <= 400) continue;
    const std::string comment = first_comment(file.text);
    EXPECT_TRUE(comment.find("lines") != std::string::npos && comment.find("because") != std::string::npos)
        << file.path << " has " << lines << " lines; cut it along its ideas, or say in its first comment why it has so "
        << "many (\"... lines because ...\")";
  }
}

TEST(House, HeadersOpenWithWhatTheyAre) {
  for (const SourceFile& file : cpp_files({"src"})) {
    if (!file.path.ends_with(".hpp") && !file.path.ends_with(".h")) continue;
    const std::string comment = first_comment(file.text);
    EXPECT_FALSE(comment.empty()) << file.path << " does not open with a comment that says what it is";
    EXPECT_LE(lines_of(comment).size(), 8u) << file.path << " opens with more than a reader takes in at once";
  }
}

TEST(House, NoUtils) {
  for (const SourceFile& file : cpp_files({"src", "apps", "tests", "bench", "examples"})) {
    std::string name = std::filesystem::path(file.path).stem().string();
    for (const char* word : {"util", "utils", "helper", "helpers", "misc", "common"})
      EXPECT_NE(name, word) << file.path << ": the name says nothing";
  }
}

}  // namespace
}  // namespace sightline::house
