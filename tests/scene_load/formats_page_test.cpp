// docs/formats.md names a test for what it says: each of them exists.
#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <set>
#include <sstream>

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

TEST(FormatsPage, NamesTestsThatExist) {
  std::stringstream page;
  page << std::ifstream(std::string(SIGHTLINE_SOURCE_DIR) + "/docs/formats.md").rdbuf();
  const std::string text = page.str();
  const std::set<std::string> tests = tests_of_this_program();
  const std::regex name("`([A-Z]\\w*\\.[A-Z]\\w*)`");
  int named = 0;
  for (auto match = std::sregex_iterator(text.begin(), text.end(), name); match != std::sregex_iterator(); ++match) {
    EXPECT_TRUE(tests.contains((*match)[1])) << "docs/formats.md names the test " << (*match)[1] << ", there is none";
    ++named;
  }
  EXPECT_GT(named, 40);
}

}  // namespace
}  // namespace sightline::test
