// A file that appears whole or not at all: written under a temporary name in the same folder, then renamed. What cannot
// be renamed over (standard output, a device, a pipe) is written directly.
#pragma once

#include <cstdio>
#include <filesystem>
#include <string_view>

namespace sightline {

class OutputFile {
 public:
  /// Opens at once, so that a place which cannot be written is told before the work. "-" is standard output; of a link
  /// the target is replaced, the link stays. Throws InputError (file, "", reason).
  explicit OutputFile(std::filesystem::path file);
  /// Removes the temporary file unless commit() has renamed it.
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Throws InputError if it could not be written.
  void write(std::string_view bytes);
  /// Puts the file in its place, over any file of that name. Throws InputError if any of it could not be written.
  void commit();

 private:
  [[noreturn]] void fail(const char* what) const;
  std::filesystem::path file_, temporary_;
  std::FILE* stream_ = nullptr;
  int slot_ = -1;  // where remove_unfinished_files() finds the temporary name
};

/// Removes the temporary files of all OutputFiles that are open; for a signal handler that ends the program.
/// Async-signal-safe.
void remove_unfinished_files() noexcept;

}  // namespace sightline
