// Runs the program as a person would, and looks at what it leaves: exit code, standard output, standard error.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace sightline::cli_test {

inline std::string read_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

struct Outcome {
  int code = -1;  // exit code; 1000 + signal if it was killed
  std::string out, err;
  [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(out); }
};

/// A test with a folder of its own that is gone afterwards.
class ProgramTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "sightline_cli_XXXXXX";
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::filesystem::path file(const std::string& name) const { return folder_ / name; }

  /// Starts the program; its output goes to files of the folder.
  pid_t start(const std::vector<std::string>& words) const {
    const pid_t child = fork();
    if (child != 0) return child;
    redirect("stdout", STDOUT_FILENO);
    redirect("stderr", STDERR_FILENO);
    std::vector<char*> arguments{const_cast<char*>("sightline")};
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    execv(SIGHTLINE_TOOL, arguments.data());
    _exit(127);
  }

  Outcome finish(pid_t child) const {
    int status = 0;
    waitpid(child, &status, 0);
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
    return {code, read_file(file("stdout")), read_file(file("stderr"))};
  }

  Outcome run(const std::vector<std::string>& words) const { return finish(start(words)); }

  /// Expects this exit code, nothing on standard output, and one line on standard error that contains `part`.
  void expect_complaint(const std::vector<std::string>& words, int code, const std::string& part) const {
    const Outcome outcome = run(words);
    std::string line;
    for (const std::string& word : words) line += " " + word;
    EXPECT_EQ(outcome.code, code) << line << "\n" << outcome.err;
    EXPECT_EQ(outcome.out, "") << line;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << line << "\n" << outcome.err;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << line << "\n" << outcome.err;
  }

 private:
  void redirect(const char* name, int descriptor) const {
    dup2(open(file(name).c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), descriptor);
  }
  std::filesystem::path folder_;
};

}  // namespace sightline::cli_test
