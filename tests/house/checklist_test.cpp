// Every test that docs/checklist.md names exists.
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <string>

#include "house/files.hpp"

namespace sightline::house {
namespace {

TEST(House, TheChecklistNamesTestsThatExist) {
  const std::regex defined(R"((?:TEST(?:_F|_P)?|RC_GTEST_PROP)\(\s*(\w+),\s*(\w+)\s*[,)])"),
      named(R"(`([A-Z]\w+\.[A-Z]\w+)`)");
  const std::sregex_iterator none;
  std::set<std::string> tests;
  for (const SourceFile& file : cpp_files({"tests"}))
    for (std::sregex_iterator m(file.text.begin(), file.text.end(), defined); m != none; ++m)
      tests.insert((*m)[1].str() + "." + (*m)[2].str());
  const std::string page = read_text(root() / "docs/checklist.md");
  std::size_t names = 0;
  for (std::sregex_iterator m(page.begin(), page.end(), named); m != none; ++m, ++names)
    EXPECT_TRUE(tests.contains((*m)[1].str())) << (*m)[1].str();
  EXPECT_GT(names, 150u);
}

}  // namespace
}  // namespace sightline::house
