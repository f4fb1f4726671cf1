// Where results go: files that appear whole or not at all, standard output, and a progress bar beside them.
#pragma once

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace sightline::cli {

/// A file that is written beside its place under a temporary name and put there by commit(); without commit() nothing
/// is left. "-" is standard output; what is no regular file (a device, a pipe) is written directly.
class OutputFile {
 public:
  /// Opens at once, so that a place which cannot be written is told before the work. Throws InputError.
  explicit OutputFile(std::filesystem::path file);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::string_view bytes);
  /// Throws InputError if any of it could not be written.
  void commit();

 private:
  [[noreturn]] void fail(const char* what) const;
  std::filesystem::path file_, temporary_;
  std::FILE* stream_ = nullptr;
};

/// Throws InputError if standard output could not take all that was printed.
void flush_stdout();

/// True if standard output is a terminal and NO_COLOR is not set.
bool stdout_has_colour();

/// One warning line on standard error.
void warn(std::string_view line);

/// "[#####.....] 34/120 label" on standard error, if that is a terminal; redrawn at most ten times a second.
class Progress {
 public:
  Progress(std::string_view label, std::size_t total, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void show(std::size_t done);

 private:
  std::string label_;
  std::size_t total_;
  bool active_;
  std::chrono::steady_clock::time_point last_{};
};

}  // namespace sightline::cli
