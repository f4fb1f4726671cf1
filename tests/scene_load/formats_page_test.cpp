// docs/formats.md names a test for what it says: each of them exists.
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace sightline::test {
namespace {

std::set<std::string> tests_of_this_program() {
  std::set<std::string> names;
  const testing::UnitTest& all = *testing::UnitTest::GetInstance();
  for (int s = 0; s < all.total_test_suite_count(); ++s) {
    const testing::TestSuite& suite = *all.GetTestSuite(s);
    for (int t = 0; t < suite.total_test_count(); ++t) {
      names.insert(std::string(suite.name()) + "." + suite.GetTestInfo(t)->name());
    }
  }
  return names;
}

/// What stands between backticks and reads "Suite.Name", both with a capital.
std::vector<std::string> named_tests(const std::string& page) {
  std::vector<std::string> names;
  std::size_t begin = 0;
  while ((begin = page.find('`', begin)) != std::string::npos) {
    const std::size_t end = page.find('`', begin + 1);
    if (end == std::string::npos) break;
    const std::string word = page.substr(begin + 1, end - begin - 1);
    const std::size_t dot = word.find('.');
    const auto capital = [&](std::size_t i) { return i < word.size() && word[i] >= 'A' && word[i] <= 'Z'; };
    if (dot != std::string::npos && capital(0) && capital(dot + 1)) names.push_back(word);
    begin = end + 1;
  }
  return names;
}

TEST(FormatsPage, NamesTestsThatExist) {
  std::stringstream page;
  page << std::ifstream(std::string(SIGHTLINE_SOURCE_DIR) + "/docs/formats.md").rdbuf();
  const std::set<std::string> tests = tests_of_this_program();
  const std::vector<std::string> named = named_tests(page.str());
  EXPECT_GT(named.size(), 40u);
  for (const std::string& name : named) {
    EXPECT_TRUE(tests.contains(name)) << "docs/formats.md names the test " << name << ", there is none";
  }
}

}  // namespace
}  // namespace sightline::test
