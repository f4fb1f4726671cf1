// Files that appear whole or not at all.
#include "sightline/scene/save/output_file.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

namespace sightline {
namespace {

TEST(OutputFile, ASignalAtAnyMomentLeavesNothingBehind) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "output_file_signal";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  for (int round = 0; round < 200; ++round) {
    const pid_t child = fork();
    if (child == 0) {
      std::signal(SIGTERM, [](int) {
        remove_unfinished_files();
        _exit(0);
      });
      for (;;) OutputFile(folder / "out").write("half");
    }
    usleep(static_cast<useconds_t>(500 + 37 * round % 1000));
    kill(child, SIGTERM);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(std::filesystem::is_empty(folder)) << "round " << round;
  }
  std::filesystem::remove_all(folder);
}

TEST(OutputFile, AppearsOnlyWhenCommitted) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "output_file_committed";
  std::filesystem::remove(file);
  { OutputFile(file).write("lost"); }
  EXPECT_FALSE(std::filesystem::exists(file));
  OutputFile output(file);
  output.write("kept");
  output.commit();
  EXPECT_EQ(std::filesystem::file_size(file), 4u);
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace sightline
