// Where results go: files that appear whole or not at all (OutputFile), standard output, and a progress beside them.
#pragma once

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

#include "options.hpp"
#include "sightline/scene/save/output_file.hpp"

namespace sightline::cli {

/// Standard streams that the caller has closed are occupied, so that no output file takes the place of one and gets
/// what is printed. Call first of all.
void occupy_closed_streams();

/// Throws InputError if standard output could not take all that was printed.
void flush_stdout();

/// True if standard output is a terminal and NO_COLOR is not set.
bool stdout_has_colour();

/// Text on standard error. That nobody can read it there is no error.
void tell(std::string_view text);

/// One warning line on standard error.
void warn(std::string_view line);

/// How all Progress from now on shows itself; main sets what --progress says.
void set_progress(ProgressKind kind);

/// How far a long work is, on standard error, told at most ten times a second: "[#####.....] 34/120 label" where that
/// is a terminal; with --progress json, whether or not it is quiet, lines {"progress":"label","done":34,"total":120},
/// the first and the last of them always.
class Progress {
 public:
  Progress(std::string_view label, std::size_t total, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void show(std::size_t done);

 private:
  void print_line();
  std::string label_;
  std::size_t total_, done_ = 0;
  bool bar_, lines_, told_ = false;
  std::chrono::steady_clock::time_point last_{};
};

}  // namespace sightline::cli
