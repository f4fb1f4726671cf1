// A number measured once: kept, found again, and measured anew whenever the file is of no use.
#include "sightline/core/kept_number.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace sightline {
namespace {

namespace fs = std::filesystem;

class KeptNumber : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("sightline_kept_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
    set("XDG_CACHE_HOME", folder_.string());
  }
  void TearDown() override {
    ::unsetenv("XDG_CACHE_HOME");
    if (!home_.empty()) ::setenv("HOME", home_.c_str(), 1);
    fs::remove_all(folder_);
  }
  static void set(const char* name, const std::string& value) { ::setenv(name, value.c_str(), 1); }
  /// What comes back if measuring gives `value`, and whether it was measured.
  double ask(double value) {
    measured_ = false;
    return kept_number("number", 0.5, 8.0, [&] {
      measured_ = true;
      return value;
    });
  }
  [[nodiscard]] fs::path file() const { return folder_ / "sightline" / "number"; }
  void write(const std::string& text) const {
    fs::create_directories(file().parent_path());
    std::ofstream(file()) << text;
  }
  fs::path folder_;
  std::string home_ = std::getenv("HOME") != nullptr ? std::getenv("HOME") : "";
  bool measured_ = false;
};

TEST_F(KeptNumber, IsMeasuredOnce) {
  EXPECT_EQ(ask(2.0), 2.0);
  EXPECT_TRUE(measured_);
  EXPECT_EQ(ask(4.0), 2.0);
  EXPECT_FALSE(measured_);
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(file().parent_path())) ++files;
  EXPECT_EQ(files, 1u);  // nothing temporary is left
}

TEST_F(KeptNumber, NonsenseIsMeasuredAnewAndReplaced) {
  for (const char* text : {"", "nonsense", "nan", "9", "-1", "inf", "0.4999"}) {
    write(text);
    EXPECT_EQ(ask(2.0), 2.0) << text;
    EXPECT_TRUE(measured_) << text;
    EXPECT_EQ(ask(4.0), 2.0) << text;
    EXPECT_FALSE(measured_) << text;
  }
}

TEST_F(KeptNumber, AFolderThatCannotBeWrittenIsNoError) {
  std::ofstream(folder_ / "sightline") << "a file where the folder should be";
  EXPECT_EQ(ask(2.0), 2.0);
  EXPECT_EQ(ask(4.0), 4.0);
  EXPECT_TRUE(measured_);
  fs::remove(folder_ / "sightline");
  fs::create_directories(file());  // a folder where the file should be
  EXPECT_EQ(ask(2.0), 2.0);
  EXPECT_EQ(ask(4.0), 4.0);
}

TEST_F(KeptNumber, HomeIsTheSecondChoiceAndNoneIsNoError) {
  ::unsetenv("XDG_CACHE_HOME");
  set("HOME", folder_.string());
  EXPECT_EQ(ask(2.0), 2.0);
  EXPECT_EQ(ask(4.0), 2.0);
  EXPECT_TRUE(fs::exists(folder_ / ".cache" / "sightline" / "number"));
  set("XDG_CACHE_HOME", "relative/path");  // to be ignored, says the specification
  EXPECT_EQ(ask(4.0), 2.0);
  ::unsetenv("HOME");
  ::unsetenv("XDG_CACHE_HOME");
  EXPECT_EQ(ask(4.0), 4.0);
}

}  // namespace
}  // namespace sightline
