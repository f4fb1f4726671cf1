#include "sightline/scene/save/output_file.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstring>
#include <random>
#include <string>
#include <system_error>

#include "sightline/scene/input_error.hpp"

namespace sightline {

namespace fs = std::filesystem;

namespace {

/// A temporary name where a signal handler can read it: fixed memory, and a flag that is set last and cleared first.
/// What finds no free slot is merely not removed when a signal ends the program.
struct UnfinishedName {
  std::atomic<bool> taken{false}, valid{false};
  std::array<char, PATH_MAX> name{};
};
std::array<UnfinishedName, 8> unfinished;
static_assert(std::atomic<bool>::is_always_lock_free);

/// The slot that holds the name from now on, -1 if none was free.
int remember(const std::string& name) {
  if (name.size() >= PATH_MAX) return -1;
  for (std::size_t i = 0; i < unfinished.size(); ++i) {
    if (unfinished[i].taken.exchange(true)) continue;
    std::memcpy(unfinished[i].name.data(), name.c_str(), name.size() + 1);
    unfinished[i].valid = true;
    return static_cast<int>(i);
  }
  return -1;
}

void forget(int slot) {
  if (slot < 0) return;
  unfinished[static_cast<std::size_t>(slot)].valid = false;
  unfinished[static_cast<std::size_t>(slot)].taken = false;
}

}  // namespace

void remove_unfinished_files() noexcept {
  for (UnfinishedName& file : unfinished)
    if (file.valid) unlink(file.name.data());
}

OutputFile::OutputFile(fs::path file) : file_(std::move(file)) {
  if (file_ == "-") {
    stream_ = stdout;
    return;
  }
  std::error_code ignored;
  if (fs::is_symlink(file_, ignored)) file_ = fs::weakly_canonical(file_, ignored);
  if (fs::is_directory(file_, ignored)) throw InputError(file_.string(), "", "cannot write: is a folder");
  const bool direct = fs::exists(file_, ignored) && !fs::is_regular_file(file_, ignored);
  // A name of its own for every writer, also for two of one process or of two machines on one disk.
  if (!direct) {
    temporary_ = file_.string() + "." + std::to_string(std::random_device()()) + ".part";
    slot_ = remember(fs::absolute(temporary_, ignored).string());  // before the file is there: a signal may come between
  }
  stream_ = std::fopen(direct ? file_.c_str() : temporary_.c_str(), "wb");
  if (stream_ == nullptr) {
    const int reason = errno;
    forget(slot_);
    temporary_.clear();
    errno = reason;
    fail("cannot write");
  }
}

OutputFile::~OutputFile() {
  if (stream_ != nullptr && stream_ != stdout) std::fclose(stream_);
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove(temporary_, ignored);
  forget(slot_);
}

void OutputFile::fail(const char* what) const {
  throw InputError(file_ == "-" ? "standard output" : file_.string(), "",
                   std::string(what) + ": " + std::strerror(errno));
}

void OutputFile::write(std::string_view bytes) {
  if (bytes.empty()) return;  // fwrite must not be given a null pointer, whatever the count
  if (std::fwrite(bytes.data(), 1, bytes.size(), stream_) != bytes.size()) fail("cannot write");
}

void OutputFile::commit() {
  if (std::fflush(stream_) != 0) fail("cannot write");
  if (stream_ == stdout) return;
  const bool closed = std::fclose(stream_) == 0;
  stream_ = nullptr;
  if (!closed) fail("cannot write");
  if (temporary_.empty()) return;
  if (std::rename(temporary_.c_str(), file_.c_str()) != 0) fail("cannot put in place");
  temporary_.clear();
}

}  // namespace sightline
