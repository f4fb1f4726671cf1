// Work of a library that may crash, hang or eat all memory on a broken file, done in a process of its own (POSIX fork).
// Promise: whatever the work does, the caller gets its bytes or an InputError, and leaves no process behind.
#pragma once

#include <filesystem>
#include <functional>

#include "sightline/scene/load/file_bytes.hpp"

namespace sightline {

/// Where the work puts its result, piece by piece.
class ByteSink {
 public:
  explicit ByteSink(int descriptor) : descriptor_(descriptor) {}
  /// Ends the process if nobody reads any more.
  void write(const void* bytes, std::size_t count);

 private:
  int descriptor_;
};

/// Runs `work` in a child process and returns what it wrote. It may throw before it writes: its message becomes the
/// reason of an InputError about `file`, as do a crash, more than 5 s of processor time and 1 s for each MB of the
/// file, and more memory than 8 GiB and 64 times the file. The work must not use threads or locks of the caller.
Bytes run_in_child(const std::filesystem::path& file, const std::function<void(ByteSink&)>& work);

}  // namespace sightline
